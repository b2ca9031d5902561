# SPDX-License-Identifier: BSD-3-Clause
# Sourced by scripts that consist of steps: step NAME [PLACE] says that the next one begins, and its
# place among all (1/3). If LIDARENA_COSTS names a file, each step that ends adds a line to it: its
# name, its seconds by the clock, and the CPU-seconds of the programs that it ran and waited for,
# separated by tabs.
step_name=

# Sets cpu to the CPU time of this shell's finished programs, in hundredths of a second (proc(5), stat,
# cutime and cstime).
cpu_of_programs() {
  local stat
  read -r stat </proc/$$/stat
  read -ra stat <<<"${stat##*) }"
  cpu=$(((stat[13] + stat[14]) * 100 / $(getconf CLK_TCK)))
}

end_step() {
  if [ -n "$step_name" ] && [ -n "${LIDARENA_COSTS:-}" ]; then
    local cpu
    cpu_of_programs
    printf '%s\t%d\t%d\n' "$step_name" $((SECONDS - step_began)) $(((cpu - step_cpu) / 100)) >>"$LIDARENA_COSTS"
  fi
  step_name=
}

step() {
  end_step
  local cpu
  cpu_of_programs
  step_name=$1 step_began=$SECONDS step_cpu=$cpu
  printf '\n== %s%s (%ds)\n' "${2:+$2 }" "$1" "$SECONDS"
}

trap end_step EXIT
