# Sourced by the scripts before they do anything. With --help (or -h) as the first argument: prints the comment that the
# script begins with, and ends.
case "${1:-}" in
  -h | --help)
    sed -n '2,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$0"
    exit 0 ;;
esac

# `usage WORDS`: what the script is called with; status 2.
usage() {
  echo "usage: scripts/$(basename "$0") $* (--help says more)" >&2
  exit 2
}

# `no_options "$1" WORDS`: an option that is not known.
no_options() {
  local first=$1
  shift
  case "$first" in -*) usage "$@" ;; esac
}
