#!/bin/sh
# Compiles the kernels of a program that is laid out, for two levels of x86-64: so that the first
# start of a package compiles nothing. They lie beside the program, in Python's folders for code.
# Use: packaging/compile-kernels.sh FOLDER-OF-LIBRARIES; PYTHON is python3.
set -eu

library=$(realpath "$1")
python=${PYTHON:-python3}
test "$(uname -m)" = x86_64 || exit 0
top=$(mktemp -d)
trap 'rm -rf "$top"' EXIT

# Compiled code names the files of its errors: through this link, without the folder of the build.
neurotouch() {
    env -i PATH="$PATH" HOME="$home" XDG_RUNTIME_DIR="$home" PYTHONPATH=/proc/self/cwd \
        PYTHONDONTWRITEBYTECODE=1 PYTHONHASHSEED=0 NUMBA_CPU_NAME="$level" NUMBA_CPU_FEATURES= \
        "$python" -P -m neurotouch_hid "$@" > "$home/log" 2>&1 || {
        tail -n 40 "$home/log" >&2
        return 1
    }
}

# What plays with every source, and what looks at recordings.
play() {
    level=$1 home=$top/$1
    mkdir -m 700 "$home"
    cd "$library"
    neurotouch service --compile
    neurotouch service --source video: --compile
    neurotouch run --source sim:tour --device memory --seconds 1 --show nothing
    neurotouch record "$home/clip.mkv" --source sim:tour,uvc=60 --seconds 2 --plain
    neurotouch simulate "$home/play" --users 1 --minutes 0.1
    neurotouch evaluate "$home"/play/*push.aedat4 --method neurotouch --method paper
    neurotouch simulate "$home/frames" --users 1 --minutes 0.1 --camera uvc --fps 60
    neurotouch evaluate "$home"/frames/*push.mkv
}

play x86-64-v2 &
first=$!
play x86-64-v3 &
second=$! failed=
wait $first || failed=yes
wait $second || failed=yes
test -z "$failed"
# These only serve kernels that are compiled and call others.
find "$library/neurotouch_hid" -name '*.nbc' -delete
