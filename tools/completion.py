#!/usr/bin/env python3
"""Prints the bash completion of programs, from their help: completion.py PROGRAM..."""

import sys

from prose.program import Program

FUNCTION = """_clearway_words() {{
  case "$1" in
{cases}
  esac
}}
_clearway_complete() {{
  local command=${{COMP_WORDS[0]##*/}} word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    if [ -n "$(_clearway_words "$command $word")" ]; then command+=" $word"; fi
  done
  COMPREPLY=($(compgen -W "$(_clearway_words "$command")" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}"""

programs = [Program(path) for path in sys.argv[1:]]
options = {command: names for program in programs for command, names in program.options.items()}
cases = []
for command, names in options.items():
    below = [other.split()[-1] for other in options if other.rpartition(" ")[0] == command]
    cases.append(f'    "{command}") echo "{" ".join([*below, *sorted(names)])}" ;;')
print(FUNCTION.format(cases="\n".join(cases)))
for program in programs:
    print(f"complete -o default -F _clearway_complete {program.name}")
