# What the scripts share that plant faults: one changed line in a copy of the sources, which something has to notice.
# Sourced by Bash that has set root and sourced cells.sh. It then says fault for each, make_copy, and plant_faults.
declare -A fault_files fault_edits fault_texts
faults=()

# fault NAME FILE SED-SCRIPT WHAT
fault() { faults+=("$1"); fault_files[$1]=$2 fault_edits[$1]=$3 fault_texts[$1]=$4; }

# choose_faults NAME...: those alone, if there are any.
choose_faults() {
  local name
  for name in "$@"; do [ -n "${fault_files[$name]:-}" ] || stop "'$name' is none of: ${faults[*]}"; done
  [ $# = 0 ] || faults=("$@")
}

# make_copy TARGET CMAKE_ARGUMENT...: the sources in $work, and how to build the target there. One instruction set besides
# scalar code is enough.
make_copy() {
  target=$1
  shift
  local isa launcher
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  case $(uname -m) in
    x86_64) isa=$(for i in avx512f:avx512 avx2:avx2 sse4_2:sse42; do grep -qw "${i%:*}" /proc/cpuinfo && { echo "${i#*:}"; break; }; done) ;;
    aarch64) isa=neon ;;
    *) isa= ;;
  esac
  (cd "$root" && git ls-files -z -c -o --exclude-standard | xargs -0 cp --parents -t "$work" 2>"$work/said") || stop "the sources cannot be copied: $(head -n 1 "$work/said")"
  launcher=$(have ccache && echo -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  # shellcheck disable=SC2086
  cmake -G Ninja -S "$work" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DNEPHROID_ISAS="${isa:-none}" $launcher "$@" >"$work/said" 2>&1 ||
    { tail -n 5 "$work/said" >&2; stop "it cannot be configured"; }
  build_copy || { grep -m 5 error "$work/said" >&2; stop "the sources cannot be built"; }
}
build_copy() { cmake --build "$work/build" --target "$target" >"$work/said" 2>&1; }

# plant_faults: calls is_noticed NAME with each fault in its place; what it leaves in $work/said is shown where it fails.
plant_faults() {
  local name file
  for name in "${faults[@]}"; do
    file=$work/${fault_files[$name]}
    cp -p "$file" "$work/original"
    sed -i "${fault_edits[$name]}" "$file"
    if cmp -s "$file" "$work/original"; then
      echo "${fault_files[$name]} has no such line: the fault $name needs a new one" >"$work/said"
      fail "$name: ${fault_texts[$name]}" "$work/said"
    elif build_copy && is_noticed "$name"; then
      pass "$name: ${fault_texts[$name]}"
    else
      fail "$name: ${fault_texts[$name]}" "$work/said"
    fi
    cp "$work/original" "$file" # newer than what was built of it
  done
}
