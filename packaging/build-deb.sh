#!/bin/sh
# Builds the package for the Debian or Ubuntu it runs on, without network; the same bytes each time.
# Use: packaging/build-deb.sh WHEEL WHEELHOUSE OUTPUT-FOLDER (make deb does)
set -eu

wheel=$(realpath "$1") wheelhouse=$(realpath "$2") output=$(realpath "$3")
cd "$(dirname "$0")/.."

missing=
for need in dpkg-buildpackage:dpkg-dev dh:debhelper; do
    command -v "${need%:*}" > /dev/null || missing="$missing ${need#*:}"
done
/usr/bin/python3 -m pip --version > /dev/null 2>&1 || missing="$missing python3-pip"
if [ -n "$missing" ]; then
    echo "To build the package, Debian's own tools are needed: apt install$missing" >&2
    exit 1
fi

: "${SOURCE_DATE_EPOCH:=$(git log -1 --format=%ct)}"
export SOURCE_DATE_EPOCH
# Debian's testing release has no number.
release=$(. /etc/os-release && echo "$ID${VERSION_ID:-$VERSION_CODENAME}" | sed 's/^debian/deb/')
version=$(basename "$wheel" | cut -d- -f2)+$release

top=$(mktemp -d)
trap 'rm -rf "$top"' EXIT
tree=$top/neurotouch-hid
mkdir "$tree"
cp -r packaging udev README.md "$wheel" "$tree"
mkdir "$tree/docs"
cp -r docs/*.md docs/develop docs/pictures docs/research "$tree/docs"
mv "$tree/packaging/debian" "$tree/debian"
ln -s "$wheelhouse" "$tree/wheelhouse"
cat > "$tree/debian/changelog" << END
neurotouch-hid ($version) unstable; urgency=medium

  * What is new is in the project's own CHANGELOG.md.

 -- The neurotouch_hid maintainers <maintainers@neurotouch-hid.invalid>  $(date -R -d "@$SOURCE_DATE_EPOCH")
END

# Debian's tools before those of any virtual environment; settings of pip stay outside. What is needed
# was asked for above: a compiler, which dpkg would ask for, is not.
cd "$tree"
env -u PIP_FIND_LINKS PATH=/usr/sbin:/usr/bin:/sbin:/bin PIP_CONFIG_FILE=/dev/null \
    dpkg-buildpackage --no-sign --no-check-builddeps --build=binary > "$top/log" 2>&1 || {
    tail -n 40 "$top/log" >&2
    exit 1
}
mv "$top"/*.deb "$output"
ls "$output/neurotouch-hid_${version}_"*.deb
