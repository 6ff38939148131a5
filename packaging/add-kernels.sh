#!/bin/sh
# Adds compiled kernels to a wheel: the first start after 'pipx install' then compiles nothing. Where
# they do not fit (another Python, numba or processor), the program compiles as without them.
# Use: packaging/add-kernels.sh WHEEL LIBRARY...; each LIBRARY has this wheel installed, and was given
# to compile-kernels.sh. PYTHON is python3, and has the library "wheel".
set -eu

wheel=$(realpath "$1") python=${PYTHON:-python3}
shift
top=$(mktemp -d)
trap 'rm -rf "$top"' EXIT
"$python" -m wheel unpack --dest "$top" "$wheel"
content=$(echo "$top"/*)
for library; do
    (cd "$library" && find neurotouch_hid -name '*.code' -exec cp --parents -t "$content" {} +)
done
"$python" -m wheel pack --dest-dir "$(dirname "$wheel")" "$content"
