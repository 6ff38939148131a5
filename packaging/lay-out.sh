#!/bin/sh
# Lays the program out as packages have it: one folder of libraries that no other program uses.
# Use: packaging/lay-out.sh FOLDER WHEEL WHEELHOUSE [--with-service]; PYTHON is python3.
# Needs no network. The RPM, the package for Arch and the sysext image are made with it.
set -eu

folder=$(realpath "$1") wheel=$(realpath "$2") wheelhouse=$(realpath "$3") service=${4:-}
python=${PYTHON:-python3}
cd "$(dirname "$0")/.."
library=$folder/usr/lib/neurotouch-hid
export PYTHONDONTWRITEBYTECODE=1

pip() {
    env -u PIP_FIND_LINKS PIP_CONFIG_FILE=/dev/null "$python" -m pip install --isolated --no-index \
        --no-deps --no-compile --no-cache-dir --disable-pip-version-check --only-binary=:all: \
        --root-user-action=ignore --quiet --target "$library" "$@"
}
pip --require-hashes --find-links "$wheelhouse" -r packaging/requirements.lock
rm -rf "$library/bin"
pip --find-links "$(dirname "$wheel")" "neurotouch-hid==$(basename "$wheel" | cut -d- -f2)"
rm -rf "$library/bin" "$library/share"
find "$library" -type d \( -name tests -o -name sample_data \) -prune -exec rm -rf {} +
find "$library" -name '*.a' -delete
# A folder without __init__.py loses against a package "backports" of the system's Python.
test ! -d "$library/backports" || touch "$library/backports/__init__.py"

install -D -m 755 packaging/launcher.py "$folder/usr/bin/neurotouch"
# The libraries fit this Python only. Another one would fail somewhere inside them.
sed -i "1s,python3,$("$python" -c 'import sys; print("python3.%d" % sys.version_info.minor)')," \
    "$folder/usr/bin/neurotouch"
run() { PYTHONPATH=$library "$python" "$@"; }
completion() {
    mkdir -p "$(dirname "$2")"
    run -m neurotouch_hid completion "$1" > "$2"
}
completion bash "$folder/usr/share/bash-completion/completions/neurotouch"
completion zsh "$folder/usr/share/zsh/site-functions/_neurotouch"
completion fish "$folder/usr/share/fish/vendor_completions.d/neurotouch.fish"
mkdir -p "$folder/usr/share/man/man1"
run packaging/man/make_page.py > "$folder/usr/share/man/man1/neurotouch.1"
install -D -m 644 -t "$folder/usr/share/applications" packaging/desktop/*.desktop
install -D -m 644 -t "$folder/usr/share/metainfo" packaging/desktop/*.metainfo.xml

if [ "$service" = --with-service ]; then
    units=$folder/usr/lib/systemd/system
    install -D -m 644 -t "$folder/etc/neurotouch" packaging/etc/*
    install -D -m 644 -t "$folder/usr/lib/modules-load.d" packaging/modules-load.d/*
    install -D -m 644 -t "$folder/usr/lib/sysusers.d" packaging/sysusers.d/*
    install -D -m 644 -t "$folder/usr/lib/udev/rules.d" udev/70-neurotouch-service.rules
    install -D -m 644 -t "$folder/usr/share/man/man7" packaging/man/neurotouch-service.7
    install -D -m 644 -t "$folder/usr/lib/systemd/user" packaging/systemd/neurotouch-session.service
    install -D -m 644 -t "$units" packaging/systemd/neurotouch.service
    sed -f packaging/systemd/players.sed packaging/systemd/neurotouch.service \
        > "$units/neurotouch@.service"
    # These systems have systemd 254 or later.
    for unit in neurotouch neurotouch@; do
        install -D -m 644 -t "$units/$unit.service.d" \
            packaging/systemd/neurotouch.service.d/uinput-handed-over.conf \
            packaging/systemd/neurotouch.service.d/restart-ever-later.conf
    done
fi
PYTHON=$python packaging/compile-kernels.sh "$library"
"$python" -m compileall -q --invalidation-mode unchecked-hash -s "$folder" "$library"
