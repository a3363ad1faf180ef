# What the matrices of checks share: cells that pass, fail or are skipped, each with a line, and their count at the end.
# Sourced by POSIX shells that have set root, and jobs to build with at a time.
passed=0 failed=0 skipped=0

pass() { passed=$((passed + 1)); printf 'pass  %s\n' "$1"; }

# A name, and a file whose first lines say why.
fail() {
  failed=$((failed + 1))
  printf 'FAIL  %s\n' "$1"
  if [ -s "${2:-}" ]; then head -n 12 "$2" | cut -c 1-200 | sed 's/^/        /'; fi
}

# A name, and what is absent.
skip() { skipped=$((skipped + 1)); printf 'SKIPPED: %s: %s\n' "$1" "$2"; }

stop() { printf '%s: %s\n' "${0##*/}" "$1" >&2; exit 2; }

have() { command -v "$1" >/dev/null 2>&1; }

# The lines of a file that a pattern matches are what is wrong; none are right. A name, the pattern, the file.
none_of() {
  if [ ! -s "$3" ]; then echo "nothing to search" >"$3.found"; fail "$1" "$3.found"
  elif grep -E -- "$2" "$3" >"$3.found"; then fail "$1" "$3.found"
  else pass "$1"; fi
}

# The release build, which every matrix looks at, and where to write what building says.
bring_up_to_date() {
  if ! { [ -f "$1/CMakeCache.txt" ] || cmake -S "$root" -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DNEPHROID_TESTS=ON; } >"$2" 2>&1; then
    stop "$1 cannot be configured: see $2"
  fi
  cmake --build "$1" --target nephroid frame_hash --parallel "$jobs" >"$2" 2>&1 || stop "$1 cannot be built (has it tests?): see $2"
}

finish() {
  printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
  [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
}
