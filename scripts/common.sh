# shellcheck shell=bash
# What scripts/render, scripts/test and .ci/run share. Sourced, never run.

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# Debian and Ubuntu packages that building and testing needs.
ptexp_packages=(build-essential cmake ninja-build ccache git python3
  libglm-dev libopenexr-dev libtbb-dev libpng-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libpugixml-dev libtinyobjloader-dev libtinygltf-dev libstb-dev libembree-dev libgtest-dev
  libjpeg-dev zlib1g-dev)

die() {
  printf '%s: %s\n' "${0##*/}" "$1" >&2
  exit 1
}

# usage FILE: prints the comment at the top of a script, which is its help.
usage() {
  awk 'NR == 1 { next } !/^#/ { exit } { sub(/^# ?/, ""); print }' "$1"
}

# install_missing PACKAGE...: installs those that are not there. Needs neither root nor a network
# when all of them are.
install_missing() {
  local package as_root=() missing=()
  if [[ ${PTEXP_INSTALL:-on} == off ]]; then
    return
  fi
  if ! command -v dpkg-query >/dev/null; then
    printf 'Not a Debian or Ubuntu system: expecting the equivalents of %s\n' "$*" >&2
    return
  fi
  for package in "$@"; do
    if [[ " $(dpkg-query --show --showformat='${db:Status-Status} ' "$package" 2>/dev/null) " \
      != *" installed "* ]]; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then
    return
  fi
  printf 'Installing %s\n' "${missing[*]}"
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      die "root is needed once: apt-get install ${missing[*]} (PTEXP_INSTALL=off skips this check)"
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install --yes --no-install-recommends "${missing[@]}"
}

# build PRESET [TARGET]: installs what is missing, configures and builds in build/PRESET below the
# repository.
build() {
  local options=()
  install_missing "${ptexp_packages[@]}"
  if [[ -n ${PTEXP_CUDA_ARCHITECTURES:-} ]]; then
    options+=("-DCMAKE_CUDA_ARCHITECTURES=$PTEXP_CUDA_ARCHITECTURES")
  fi
  # A compiler that was not there last time may have been installed since.
  if grep -qs '^CMAKE_CUDA_COMPILER:.*NOTFOUND$' "$root/build/$1/CMakeCache.txt"; then
    options+=(-UCMAKE_CUDA_COMPILER)
  fi
  cmake -S "$root" --preset "$1" "${options[@]}"
  cmake --build "$root/build/$1" --target "${2:-all}"
}
