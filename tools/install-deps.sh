#!/usr/bin/env bash
# Installs everything that building, testing and running Weir needs on Debian 12. Idempotent: when every
# package is there already it asks no package server and returns at once.
#
#   tools/install-deps.sh            everything
#   tools/install-deps.sh --check    only says what is missing (exit status 1 if anything is)
set -euo pipefail

BASE=(
  build-essential cmake ninja-build ccache git pkg-config clang-format clang-tidy lld
  libvulkan-dev libvulkan1 libvulkan-volk-dev vulkan-validationlayers spirv-headers spirv-tools
  glslang-dev glslang-tools libglm-dev libtinygltf-dev libstb-dev libopencolorio-dev libopenexr-dev libpng-dev
  libdraco-dev libmeshoptimizer-dev libembree-dev
  nlohmann-json3-dev libcli11-dev libfmt-dev libgtest-dev libbenchmark-dev python3 python3-jsonschema patchelf
  openimageio-tools parallel chromium
  libglfw3-dev libimgui-dev fonts-dejavu-core xvfb xauth
)
# For the page of weir chart. Node from elsewhere brings an npm of its own, whose package Debian's conflicts with.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then BASE+=(nodejs npm); fi
# Mesa of plain Debian 12 (22.3) has no ray tracing in its software device; the one in backports has.
BACKPORTS=(mesa-vulkan-drivers)
# An architecture-independent header that Debian has had since 13; it depends on nothing of that release.
TRIXIE=(libvulkan-memory-allocator-dev)

mesa_is_new_enough() {
  local version; version=$(dpkg-query -W -f='${Version}' mesa-vulkan-drivers 2>/dev/null) || return 1
  dpkg --compare-versions "$version" ge 25.0
}

missing=()
present=$(dpkg-query -W -f='${Package} ${Status}\n' "${BASE[@]}" "${TRIXIE[@]}" 2>/dev/null || true)
for package in "${BASE[@]}" "${TRIXIE[@]}"; do
  grep -qxF "$package install ok installed" <<<"$present" || missing+=("$package")
done
mesa_is_new_enough || missing+=("${BACKPORTS[@]}")

if [ ${#missing[@]} -eq 0 ]; then exit 0; fi
if [ "${1:-}" = "--check" ]; then echo "missing: ${missing[*]}"; exit 1; fi
if ! command -v apt-get >/dev/null; then
  echo "install-deps: this script knows Debian's apt-get only; install by hand: ${missing[*]}" >&2; exit 1
fi
SUDO=; [ "$(id -u)" -eq 0 ] || SUDO=sudo
. /etc/os-release

# The mirror that this machine already uses, so that a local one is kept.
mirror=$(grep -hE '^(URIs:|deb )' /etc/apt/sources.list.d/debian.sources /etc/apt/sources.list 2>/dev/null |
         grep -oE 'https?://[^ ]+' | grep -v security | head -n 1 || true)
mirror=${mirror:-http://deb.debian.org/debian}

if [ "${VERSION_CODENAME:-}" = bookworm ]; then
  $SUDO tee /etc/apt/sources.list.d/weir.sources >/dev/null <<SOURCES
Types: deb
URIs: $mirror
Suites: bookworm-backports trixie
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
SOURCES
  # Nothing is ever taken from the newer release but the one header package.
  $SUDO tee /etc/apt/preferences.d/weir >/dev/null <<PINS
Package: *
Pin: release n=trixie
Pin-Priority: -1

Package: ${TRIXIE[*]}
Pin: release n=trixie
Pin-Priority: 500
PINS
fi

export DEBIAN_FRONTEND=noninteractive
apt_get() { $SUDO env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 -y -q "$@"; }
apt_get update
apt_get install --no-install-recommends "${BASE[@]}" "${TRIXIE[@]}"
if [ "${VERSION_CODENAME:-}" = bookworm ]; then
  apt_get install --no-install-recommends -t bookworm-backports "${BACKPORTS[@]}"
else
  apt_get install --no-install-recommends "${BACKPORTS[@]}"
fi
