# shellcheck shell=bash
# A bare Debian in a folder, in which scripts/deb_test and scripts/fresh_test run a newcomer's
# commands. Needs root (debootstrap, chroot), a network, and a Debian. Sourced after common.sh.

# of this machine
# shellcheck disable=SC2034 # for those that source this
debian_release=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")

# make_bare_debian RELEASE FOLDER: anew, from this machine's mirror. The tree as debootstrap made it
# and the packages that are installed into it later stay in build/bare_debian, for the next one.
make_bare_debian() {
  local release=$1 tree=$2 kept=${root:?}/build/bare_debian/$1 mirror file options=() script=()
  local ubuntu_keys=/usr/share/keyrings/ubuntu-archive-keyring.gpg
  ((EUID == 0)) || die "root is needed: debootstrap and chroot"
  install_missing debootstrap
  # shellcheck disable=SC2016 # apt-get's own variables
  mirror=$(apt-get indextargets --format '$(SITE)' "Codename: $debian_release" | head -n 1)
  if [[ $release =~ ^(jammy|noble)$ ]]; then
    mirror=${PTEXP_UBUNTU_MIRROR:-}
    # Debian 12 has no such package: there the file must be brought.
    [[ -z $mirror || -e $ubuntu_keys ]] || install_missing ubuntu-keyring
    # shellcheck disable=SC2054 # one option
    options=(--components=main,universe --keyring="$ubuntu_keys")
    script=(/usr/share/debootstrap/scripts/gutsy) # that of all Ubuntus; Debian 12 has no name of noble
  fi
  [[ -n $mirror ]] || die "apt-get indextargets names no mirror of $debian_release; for Ubuntu set \
PTEXP_UBUNTU_MIRROR"
  remove_bare_debian "$tree"
  mkdir -p "$tree"
  mkdir -p "$kept/archives/partial"
  if [[ -e $kept/tree.tar ]]; then
    tar --extract --numeric-owner --file "$kept/tree.tar" --directory "$tree"
  else
    debootstrap --variant=minbase --include=ca-certificates "${options[@]}" "$release" "$tree" \
      "$mirror" "${script[@]}"
    if mountpoint --quiet "$tree/proc"; then umount "$tree/proc"; fi
    tar --create --numeric-owner --one-file-system --file "$kept/tree.tar.new" --directory "$tree" .
    mv "$kept/tree.tar.new" "$kept/tree.tar"
  fi
  for file in /etc/apt/apt.conf.d/*proxy*; do # how this machine reaches its mirror
    [[ ! -e $file ]] || cp "$file" "$tree/etc/apt/apt.conf.d/"
  done
  mountpoint --quiet "$tree/proc" || mount -t proc proc "$tree/proc"
  mount --bind "$kept/archives" "$tree/var/cache/apt/archives"
  in_bare_debian "$tree" apt-get update # a kept tree's lists may be old
}

# in_bare_debian FOLDER COMMAND...
in_bare_debian() {
  local tree=$1
  shift
  chroot "$tree" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "$@"
}

# remove_bare_debian FOLDER: but not what is mounted there.
remove_bare_debian() {
  local folder
  for folder in proc var/cache/apt/archives; do
    if mountpoint --quiet "$1/$folder"; then umount "$1/$folder"; fi
  done
  rm -rf --one-file-system "$1"
}
