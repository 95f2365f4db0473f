# Sourced by the scripts first. With --help or -h as the first argument, prints the comment at the top of the script and
# exits.
case "${1:-}" in
  -h | --help)
    sed -n '2,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$0"
    exit 0 ;;
esac

# `usage WORDS`: prints the arguments that the script takes and exits with status 2.
usage() {
  echo "usage: $0 $* (--help explains)" >&2
  exit 2
}

# `no_options "$1" WORDS`: refuses unknown options.
no_options() {
  local first=$1
  shift
  case "$first" in -*) usage "$@" ;; esac
}
