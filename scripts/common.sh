# shellcheck shell=bash
# What scripts/render, scripts/test and .ci/run share. Sourced, never run.

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# Debian and Ubuntu packages that building and testing needs.
ptexp_packages=(build-essential cmake ninja-build ccache git python3 python3-dev python3-venv python3-pip
  libglm-dev libopenexr-dev libtbb-dev libpng-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libpugixml-dev libtinygltf-dev libstb-dev libembree-dev libgtest-dev
  libjpeg-dev zlib1g-dev libxxhash-dev libcpp-httplib-dev
  libnanovdb-dev libblosc-dev)

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

# has_requirements PYTHON [FILE]: whether it has the packages of a file, tests/requirements.txt.
has_requirements() {
  "$1" - "${2:-$root/tests/requirements.txt}" 2>/dev/null <<'PYTHON'
import importlib.metadata, re, sys
for line in open(sys.argv[1]):
    name, operator, version = re.fullmatch(r"([\w-]*)([=<>]*)(.*)\n?", line).groups()
    found = name and importlib.metadata.version(name)
    assert operator != "==" or found == version
PYTHON
}

# set_test_python: PTEXP_TEST_PYTHON becomes a Python with the packages of tests/requirements.txt:
# the system's if it has them, else one below build/, made once. Where the packages cannot be had
# the tests that need them skip; with PTEXP_NEEDS_MITSUBA set that is an error.
set_test_python() {
  local folder=$root/build/test_python
  export PTEXP_TEST_PYTHON
  PTEXP_TEST_PYTHON=$(command -v python3)
  if has_requirements "$PTEXP_TEST_PYTHON"; then return; fi
  PTEXP_TEST_PYTHON=$folder/bin/python3
  if [[ -x $PTEXP_TEST_PYTHON ]] && has_requirements "$PTEXP_TEST_PYTHON"; then return; fi
  printf 'Installing the packages of tests/requirements.txt into %s\n' "$folder"
  if [[ ${PTEXP_INSTALL:-on} != off ]] && install_missing python3-venv python3-pip &&
    python3 -m venv "$folder" && "$PTEXP_TEST_PYTHON" -m pip install --quiet \
    --disable-pip-version-check --requirement "$root/tests/requirements.txt"; then
    return
  fi
  [[ -z ${PTEXP_NEEDS_MITSUBA:-} ]] || die "the packages of tests/requirements.txt are not there"
  printf 'Without the packages of tests/requirements.txt: tests against Mitsuba skip\n' >&2
  PTEXP_TEST_PYTHON=$(command -v python3)
}

# set_site_python: build/site_python becomes a Python with the packages of docs/requirements.txt.
set_site_python() {
  local folder=$root/build/site_python file=$root/docs/requirements.txt
  if [[ -x $folder/bin/python3 ]] && has_requirements "$folder/bin/python3" "$file"; then return; fi
  printf 'Installing the packages of docs/requirements.txt into %s\n' "$folder"
  install_missing python3-venv python3-pip
  python3 -m venv "$folder"
  "$folder/bin/python3" -m pip install --quiet --disable-pip-version-check --requirement "$file"
}

# build PRESET [TARGET...]: installs what is missing, configures and builds in build/PRESET below the
# repository.
build() {
  local options=() targets=("${@:2}")
  install_missing "${ptexp_packages[@]}"
  if [[ -n ${PTEXP_CUDA_ARCHITECTURES:-} ]]; then
    options+=("-DCMAKE_CUDA_ARCHITECTURES=$PTEXP_CUDA_ARCHITECTURES")
  fi
  if [[ -n ${PTEXP_TEST_PYTHON:-} ]]; then
    options+=("-DPTEXP_TEST_PYTHON=$PTEXP_TEST_PYTHON")
  fi
  # A compiler that was not there last time may have been installed since.
  if grep -qs '^CMAKE_CUDA_COMPILER:.*NOTFOUND$' "$root/build/$1/CMakeCache.txt"; then
    options+=(-UCMAKE_CUDA_COMPILER)
  fi
  cmake -S "$root" --preset "$1" "${options[@]}" || return
  cmake --build "$root/build/$1" --target "${targets[@]:-all}"
}

# make_deb FOLDER: builds the program for CPUs in build/deb/cpu and makes FOLDER/ptexp_VERSION_*.deb.
make_deb() {
  local build=$root/build/deb/cpu folder
  install_missing "${ptexp_packages[@]}" dpkg-dev || return
  mkdir -p "$1" && folder=$(realpath -- "$1") &&
    cmake -S "$root" --preset release -B "$build" -DPTEXP_CUDA=OFF -DPTEXP_TESTS=OFF &&
    cmake --build "$build" --target ptexp && rm -rf "$build/package" &&
    (cd "$build" && cpack -G DEB -B "$build/package") &&
    mv -- "$build"/package/ptexp_*.deb "$folder/"
}
