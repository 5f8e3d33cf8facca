#!/usr/bin/env bash
# Stands for ptexp in a test of scripts/slurm_test: "renders" a text file by sleeping, has parts,
# checkpoints and signals as ptexp has them, and as many ranks as srun starts. An image is the text
# of its options; a checkpoint has a line `done N of M` besides, and that text.
set -u

rank=${SLURM_PROCID:-0}
if [[ ${SLURM_STEP_NUM_TASKS:-1} == 1 ]]; then rank=0; fi

fail() {
  printf 'ptexp: error: %s\n' "$1" >&2
  exit 2
}

# write FILE DONE TEXT
write() {
  if ((rank == 0)); then
    printf 'done %d of %d\n%s\n' "$2" "$steps" "$3" >"$1.tmp" && mv "$1.tmp" "$1"
  fi
}

image_of() {
  sed 1d "$1"
}

is_complete() {
  [[ $(sed -n '1s/done \([0-9]*\) of \1$/yes/p' "$1") == yes ]]
}

# render FILE FIRST TEXT OUTPUT: a step takes a tenth of a second.
render() {
  local file=$1 done=$2 text=$3 output=$4 signal=0
  trap 'signal=10' USR1
  trap 'signal=15' TERM
  while ((done < steps && signal == 0)); do
    sleep 0.1 & wait $!
    ((signal != 0)) || ((++done))
  done
  if [[ -n $file ]]; then write "$file" "$done" "$text"; fi
  if ((signal != 0)); then exit $((128 + signal)); fi
  if ((rank == 0)) && [[ -n $output ]]; then printf '%s\n' "$text" >"$output"; fi
}

# A part's text is its options, a line of its own, and `part K of N`.
merge() {
  local out=$1 allow=off parts=0 count=0 input
  shift
  for input in "$@"; do
    if [[ $input == --allow-missing ]]; then allow=on && continue; fi
    [[ -s $input ]] || fail "$input: no such file"
    count=$(image_of "$input" | sed -n 's/^part [0-9]* of //p')
    if is_complete "$input"; then ((++parts)); fi
  done
  if ((parts < count)) && [[ $allow == off ]]; then fail "$((count - parts)) parts are missing"; fi
  image_of "$1" | grep -v '^part ' >"$out"
}

steps=4 checkpoint='' part='' output='' stats='' options=()
case ${1:-} in
  compare)
    a=$(grep -v '^done ' "$2") b=$(grep -v '^done ' "$3")
    [[ $a == "$b" ]]
    exit
    ;;
  merge)
    shift
    merge "$@"
    exit
    ;;
  resume)
    read -r _ first _ steps <"$2"
    render "$2" "$first" "$(image_of "$2")" ''
    exit
    ;;
esac
while (($# > 0)); do
  case $1 in
    --checkpoint) checkpoint=${2%,*} && shift ;;
    --output | -o) output=$2 && shift ;;
    --stats) stats=$2 && shift ;;
    --part) part=$2 && shift ;;
    --spp) steps=$(($2 / 8 + 4)) && options+=("$1" "$2") && shift ;;
    *) options+=("$1") ;;
  esac
  shift
done
text=${options[*]}
if [[ -n $part ]]; then
  text+=$'\n'"part ${part%/*} of ${part#*/}"
  output=''
fi
render "$checkpoint" 0 "$text" "$output"
if ((rank == 1)) && [[ -n $stats ]]; then printf '"rank 1 (fake)"\n' >"$stats"; fi
