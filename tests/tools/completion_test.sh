#!/usr/bin/env bash
# Asks the completion of bash, and that of zsh where it is installed: completion_test.sh PROGRAM
set -euo pipefail
make=$(cd "$(dirname "$0")/../.." && pwd)/tools/completion.py
program=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
python3 "$make" bash "$program" >clearway.bash
python3 "$make" zsh "$program" >_clearway
mkdir files && cd files
mkdir scans && touch 'my car.ply' path.txt
export LC_ALL=C

# What is typed, of which the last word is completed, and what is offered for it, in the order of
# the alphabet.
cases='clearway r|report,run
clearway model bo|box
clearway model |box,info,my car.ply,outline,path.txt,scans
clearway trajectory |alignment,follow,info,line,resample,smooth,thin
/usr/bin/clearway scene t|tunnel
clearway run --first|--first-pose
clearway run --mod|--model,--model-as,--model-spacing,--model-unit,--model-vertices
clearway run --env site.h5 --device |auto,cpu,cuda
clearway run --device c|cpu,cuda
clearway run --device=|auto,cpu,cuda
clearway run --device=c|cpu,cuda
clearway run --forward -|-x,-y,-z
clearway run --model-unit f|ft
clearway run --trajectory-format pose|pose-wxyz,pose-xyzw
clearway run --model m|my car.ply
clearway run --radius |
clearway convert --near p|path.txt
clearway convert --near=p|path.txt
clearway check s|scans
clearway check --near s|scans
clearway check --near --fl|--floor
clearway check -o |scans'

answer_bash() { # with = as a word of its own, as bash does
  source ../clearway.bash
  read -r -a COMP_WORDS <<<"${1//=/ = }"
  [[ $1 != *' ' ]] || COMP_WORDS+=("")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _clearway_complete
  [ ${#COMPREPLY[@]} = 0 ] || printf '%s\n' "${COMPREPLY[@]}"
}

answer_zsh() { # with stand-ins for what zsh has inside a completion alone
  zsh -f -c 'compdef() { }
    compset() { PREFIX=${PREFIX#*=} }
    compadd() { shift; print -l -- ${(M)@:#$PREFIX*} }
    _files() { if [ "$1" = -/ ]; then print -l -- $PREFIX*(N/); else print -l -- $PREFIX*(N); fi }
    source ../_clearway
    words=(${=1}) && [[ $1 != *" " ]] || words+=("")
    CURRENT=$#words PREFIX=$words[-1]
    _clearway' zsh "$1"
}

for shell in bash zsh; do
  command -v "$shell" >/dev/null ||
    { echo "completion: $shell is not installed, so it was not tried"; continue; }
  while IFS='|' read -r typed offered; do
    found=$("answer_$shell" "$typed" | sed '/^$/d' | sort | paste -sd,)
    [ "$found" = "$offered" ] ||
      { echo "completion: $shell offers '$found' for '$typed', expected '$offered'" >&2; exit 1; }
  done <<<"$cases"
done
