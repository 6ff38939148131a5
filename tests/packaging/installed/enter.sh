#!/bin/sh
# Installs the package DEB into a copy of this machine's Debian, and runs walk.py there as an
# ordinary user. Nothing outside is changed: the copy is in memory and ends with this process.
# Call it by: unshare --mount sh enter.sh DEB
set -eu
deb=$1
here=$(dirname "$(readlink -f "$0")")
top=$(mktemp -d)
mount -t tmpfs -o size=4g tmpfs "$top"
mkdir "$top/upper" "$top/work" "$top/root"
mount -t overlay overlay -o "lowerdir=/,upperdir=$top/upper,workdir=$top/work" "$top/root"
mount -t proc proc "$top/root/proc"
mount --rbind /dev "$top/root/dev"
mount -t tmpfs tmpfs "$top/root/run"
mount -t tmpfs tmpfs "$top/root/tmp"
cp "$deb" "$top/root/tmp/neurotouch-hid.deb"
cp "$here/walk.py" "$top/root/tmp/"
chmod 755 "$top/root/tmp/walk.py"
chroot "$top/root" sh -eu -c '
    useradd --create-home newcomer
    apt-get install --yes --no-install-recommends /tmp/neurotouch-hid.deb >&2
    rm /tmp/neurotouch-hid.deb
    chmod 1777 /tmp' 
exec chroot "$top/root" setpriv --reuid=newcomer --regid=newcomer --clear-groups \
    env -i HOME=/home/newcomer PATH=/usr/bin:/bin /usr/bin/python3 /tmp/walk.py
