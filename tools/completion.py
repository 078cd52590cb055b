#!/usr/bin/env python3
"""Prints the completion of programs for a shell, from their help: completion.py bash|zsh PROGRAM...

    source <(tools/completion.py bash build/release/tools/clearway)
"""

import sys

from prose.program import Entry, Program

# What stands in the facts for the value that an option or argument takes, where it has no choices.
KINDS = {"FILE": "FILE", "PATH": "FILE", "DIR": "DIR"}

# facts: of a command its commands, its options, each with a colon and the value that it takes, and
# after a colon alone what its arguments are. Both shells run what is here.
FACTS = """_clearway_facts() {{
  case "$1" in
{cases}
    *) facts="" ;;
  esac
}}
# _clearway_choose CURRENT WORD...: finds the choices, and the files (-f, or -d for folders alone),
# that may stand for the current word after the words before it.
_clearway_choose() {{
  [ -z "${{ZSH_VERSION:-}}" ] || emulate -L sh
  local current=$1 command=${{2##*/}} word="" fact kind="" place="" commands="" options=""
  shift 2
  for word in "$@"; do
    _clearway_facts "$command $word"
    [ -z "$facts" ] || command="$command $word"
  done
  choices="" files=""
  _clearway_facts "$command"
  for fact in $facts; do
    case $fact in
      :*) place=${{fact#:}} ;;
      "$word":*) kind=${{fact#*:}} ;;
      -*) options="$options ${{fact%%:*}}" ;;
      *) commands="$commands $fact" ;;
    esac
  done
  if [ -n "$kind" ]; then
    :
  elif [ "${{current#-}}" != "$current" ] || [ -z "$commands$place" ]; then
    choices=$options
  else
    choices=$commands kind=$place
  fi
  case $kind in
    FILE) files=-f ;;
    DIR) files=-d ;;
    VALUE) ;;
    *) choices="$choices $(echo "$kind" | tr , ' ')" ;;
  esac
}}
"""

BASH = FACTS + """_clearway_complete() {{
  local facts choices files word before=() current=${{COMP_WORDS[COMP_CWORD]}}
  for word in "${{COMP_WORDS[@]:0:COMP_CWORD}}"; do
    [ "$word" = = ] || before+=("$word")  # bash takes --device=cpu for three words
  done
  if [ "$current" = = ]; then current=""; fi
  _clearway_choose "$current" "${{before[@]}}"
  COMPREPLY=($(compgen -W "$choices" -- "$current"))
  if [ -n "$files" ]; then
    compopt -o filenames 2>/dev/null
    mapfile -t -O ${{#COMPREPLY[@]}} COMPREPLY < <(compgen $files -- "$current")
  fi
}}
complete -F _clearway_complete {names}"""

ZSH = """#compdef {names}
""" + FACTS + """_clearway() {{
  local facts choices files before=("${{(@)words[1,CURRENT-1]}}")
  if [[ $PREFIX == --*=* ]]; then
    before+=("${{PREFIX%%=*}}")
    compset -P '*='
  fi
  _clearway_choose "$PREFIX" "${{before[@]}}"
  case $files in
    -f) _files ;;
    -d) _files -/ ;;
  esac
  compadd -- ${{=choices}}
}}
# The first call of a function that zsh has found by its file, or `source`.
if [ "${{funcstack[1]}}" = _clearway ]; then _clearway "$@"; else compdef _clearway {names}; fi"""


def value_of(entry):
    return ",".join(entry.choices) or KINDS.get(entry.value.rstrip("."), "VALUE")


def facts(program, command):
    for section, name, text in program.entries[command]:
        entry = Entry(name, text)
        if section == "Subcommands":
            yield entry.flags
        elif section == "Positionals":
            yield ":" + value_of(entry)
        else:
            takes = f":{value_of(entry)}" if entry.value or entry.choices else ""
            yield from (flag + takes for flag in entry.flags.split(","))


shell, *paths = sys.argv[1:]
programs = [Program(path) for path in paths]
cases = [f'    "{command}") facts="{" ".join(facts(program, command))}" ;;'
         for program in programs for command in program.entries]
print({"bash": BASH, "zsh": ZSH}[shell].format(
    cases="\n".join(cases), names=" ".join(program.name for program in programs)))
