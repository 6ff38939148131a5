#!/bin/sh
# Builds a system extension for systems with a read-only /usr (SteamOS, Bazzite, Silverblue); the
# same bytes each time. Use: packaging/sysext/build.sh WHEEL WHEELHOUSE OUTPUT-FOLDER
# PYTHON names the Python of the target, with its minor version: the libraries fit no other.
set -eu

wheel=$(realpath "$1") wheelhouse=$(realpath "$2") output=$(realpath "$3")
here=$(realpath "$(dirname "$0")/..")
: "${PYTHON:=python3}" "${SOURCE_DATE_EPOCH:=$(git -C "$here" log -1 --format=%ct)}"
export PYTHON SOURCE_DATE_EPOCH
command -v mksquashfs > /dev/null || {
    echo "To build the image, squashfs-tools is needed (Debian: apt install squashfs-tools)." >&2
    exit 1
}

top=$(mktemp -d)
trap 'rm -rf "$top"' EXIT
"$here/lay-out.sh" "$top" "$wheel" "$wheelhouse"
release=$top/usr/lib/extension-release.d/extension-release.neurotouch-hid
mkdir -p "$(dirname "$release")"
# Any system: it needs only glibc, libusb and this Python. /etc stays as it is: 'neurotouch setup' writes
# the rules there, which the image could not do in time for udev.
printf 'ID=_any\nARCHITECTURE=x86-64\n' > "$release"
chmod -R u=rwX,go=rX "$top"
mksquashfs "$top" "$output/neurotouch-hid.raw" -noappend -all-root -no-xattrs -comp zstd -quiet \
    -no-progress > "$top.log" || {
    cat "$top.log" >&2
    exit 1
}
rm -f "$top.log"
ls "$output/neurotouch-hid.raw"
