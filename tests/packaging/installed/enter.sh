#!/bin/sh
# Installs the package DEB into a copy of this machine's Debian, and runs walk.py there, which types
# as an ordinary user. Nothing outside is changed: the copy is in memory and ends with this process.
# Call it by: unshare --mount sh enter.sh DEB FOLDER; what FOLDER has is in the user's home.
set -eu
deb=$1
things=$2
here=$(dirname "$(readlink -f "$0")")
top=$(mktemp -d)
mount -t tmpfs -o size=6g tmpfs "$top"
mkdir "$top/upper" "$top/work" "$top/system"
mount -t overlay overlay -o "lowerdir=/,upperdir=$top/upper,workdir=$top/work" "$top/system"
mount -t proc proc "$top/system/proc"
mount --rbind /dev "$top/system/dev"
mkdir -p "$top/system/sys/devices/system/cpu"
mount --bind /sys/devices/system/cpu "$top/system/sys/devices/system/cpu"
mount -t tmpfs tmpfs "$top/system/run"
mount -t tmpfs tmpfs "$top/system/tmp"
cp "$deb" "$top/system/tmp/neurotouch-hid.deb"
cp "$here/walk.py" "$top/system/tmp/"
cp -r "$things" "$top/system/tmp/things"
chmod -R a+rX "$top/system/tmp/walk.py" "$top/system/tmp/things"
# A package of this name, as pip puts it there for everybody, is not ours.
mkdir -p "$top/system/usr/lib/python3/dist-packages/backports"
touch "$top/system/usr/lib/python3/dist-packages/backports/__init__.py"
chroot "$top/system" sh -eu -c '
    useradd --create-home newcomer
    chmod 1777 /tmp
    # Fixes are typed with sudo; here root types them.
    # The kernel is not of this copy, and its modules stay as they are.
    printf "#!/bin/sh\n[ \"\$1\" = modprobe ] || exec \"\$@\"\n" > /usr/local/bin/sudo
    chmod 755 /usr/local/bin/sudo
    apt-get install --yes --no-install-recommends /tmp/neurotouch-hid.deb >&2
    rm /tmp/neurotouch-hid.deb'
exec chroot "$top/system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin /usr/bin/python3 /tmp/walk.py
