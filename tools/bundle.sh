#!/usr/bin/env bash
# Puts the built program into a folder that runs on another x86-64 Linux machine with a Vulkan driver and nothing else
# installed: program, plugins, shaders, graphs, scenes and every library that they need short of the C library.
#
#   tools/bundle.sh [--oracle] [--scene FILE]... OUTDIR     OUTDIR must not exist, or be an earlier bundle
# --oracle: the path tracer of tests/oracle too, with Embree (42 MB).
set -euo pipefail

usage() { sed -n '5p' "${BASH_SOURCE[0]}" | sed 's/^# *//'; }
fail() { echo "bundle.sh: $1" >&2; exit 2; }

here=$PWD
absolute() { case "$1" in /*) echo "$1" ;; *) echo "$here/$1" ;; esac; }
extra=()
out=
programs=(weir)
while [ $# -gt 0 ]; do
  case "$1" in
    --scene)
      [ $# -ge 2 ] || fail "--scene needs a file"
      [ -f "$2" ] || fail "no scene at '$2'"
      extra+=("$(absolute "$2")"); shift 2 ;;
    --oracle) programs+=(oracle); shift ;;
    -h | --help) usage; exit 0 ;;
    -*) fail "'$1' is not known; $(usage)" ;;
    *) [ -z "$out" ] || fail "one OUTDIR, not '$out' and '$1'"; out=$(absolute "$1"); shift ;;
  esac
done
[ -n "$out" ] || fail "no OUTDIR; $(usage)"
if [ -e "$out" ] && [ ! -f "$out/.weir-bundle" ]; then fail "'$out' exists and is no earlier bundle"; fi

cd "$(dirname "${BASH_SOURCE[0]}")/.."
tools/build.sh weir_app
if grep -q '^build weir_chart:' build/release/build.ninja && ! tools/build.sh weir_chart; then
  echo "bundle.sh: goes on without the page of weir chart" >&2
fi
[ ${#programs[@]} -eq 1 ] || tools/build.sh oracle
from=build/release/bin

rm -rf "$out"
mkdir -p "$out/bin" "$out/lib/runtime" "$out/lib/loader" "$out/scenes" "$out/bench"
touch "$out/.weir-bundle"
cp "${programs[@]/#/$from/}" "$from"/libweir*.so "$from"/weir_*.json "$out/bin/"
if [ -f "$from/chart.html" ]; then cp "$from/chart.html" "$out/bin/"; fi
cp -rL "$from/shaders" "$out/bin/"
cp -r graphs LICENSE "$out/"
cp bench/thesis.json "$out/bench/"
cp scenes/*.glb ${extra[@]+"${extra[@]}"} "$out/scenes/"

# The C library stays the target's own, and so does what its drivers bring.
is_c_library() { case "$1" in libc.so.* | libm.so.* | libpthread.so.* | libdl.so.* | librt.so.* | libresolv.so.* | ld-linux*) true ;; *) false ;; esac; }
for binary in "${programs[@]/#/$out/bin/}" "$out"/bin/*.so; do
  ldd "$from/$(basename "$binary")"
done | awk '$2 == "=>" && $3 ~ /^\// { print $1, $3 }' | sort -u | while read -r name path; do
  if is_c_library "$name"; then continue; fi
  case "$name" in
    libweir*) ;;
    libstdc++.so.* | libgcc_s.so.*) cp -L "$path" "$out/lib/runtime/$name" ;;
    *) cp -L "$path" "$out/lib/$name" ;;
  esac
done
loader=$(PATH=$PATH:/sbin:/usr/sbin ldconfig -p | awk '$1 == "libvulkan.so.1" && /x86-64/ && !found++ { print $NF }')
cp -L "$loader" "$out/lib/loader/libvulkan.so.1"

binaries=("${programs[@]/#/$out/bin/}" "$out"/bin/*.so "$out"/lib/*.so* "$out"/lib/*/*.so*)
chmod u+w "${binaries[@]}"
strip --strip-unneeded "${binaries[@]}"
for file in "${programs[@]/#/$out/bin/}" "$out"/bin/*.so; do patchelf --set-rpath '$ORIGIN:$ORIGIN/../lib' "$file"; done
for file in "$out"/lib/*.so*; do patchelf --set-rpath '$ORIGIN' "$file"; done

newest() { objdump -T "$@" 2>/dev/null | grep -oE "$pattern" | sort -uV | tail -n 1; }
pattern='GLIBCXX_3\.4\.[0-9]+'; needs_cxx=$(newest "$out/bin/weir" "$out"/bin/*.so "$out"/lib/*.so*)
pattern='GLIBC_[0-9.]+'; needs_c=$(newest "${binaries[@]}")

cat >"$out/weir" <<WRAPPER
#!/bin/sh
# Starts bin/weir. The C++ runtime and the Vulkan loader that lie in lib/ are used only where the machine's own are
# missing or too old: its drivers may need its own, newer ones.
here=\$(CDPATH= cd -- "\$(dirname -- "\$0")" && pwd)
PATH=\${PATH:-/usr/bin:/bin}:/sbin:/usr/sbin
own() { ldconfig -p 2>/dev/null | sed -n "s|.*\$1 (libc6,x86-64.* => ||p" | head -n 1; }
cxx=\$(own 'libstdc++\\.so\\.6')
if [ -z "\$cxx" ] || ! grep -q '$needs_cxx' "\$cxx"; then extra=\$here/lib/runtime; fi
if [ -z "\$(own 'libvulkan\\.so\\.1')" ]; then extra=\${extra:+\$extra:}\$here/lib/loader; fi
if [ -n "\${extra:-}" ]; then LD_LIBRARY_PATH=\$extra\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}; export LD_LIBRARY_PATH; fi
exec "\$here/bin/weir" "\$@"
WRAPPER
chmod +x "$out/weir"
cat >"$out/README.txt" <<TEXT
Weir, for x86-64 Linux with a Vulkan 1.3 driver. The C library must be as new as ${needs_c/_/ }. Start it with

    ./weir devices
    ./weir render graphs/restir_di.json --scene scenes/cornell.glb --size 1280x720 --frames 16 --out color=cornell.png
TEXT
echo "$out: $(du -sm "$out" | cut -f1) MiB, needs $needs_c"
