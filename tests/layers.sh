#!/bin/sh
# Fails where a file or a public header includes what stands after it, where cli, examples or bench see
# more than the public headers (cli also sees itself, base and provenance; what the browser calls also cli and report), where a system's own header is included outside
# the platform layer, and where a header does not compile alone.
# usage: layers.sh SOURCE_DIR C_COMPILER
set -eu
# From within: the names found below hold no spaces, that of the source folder may.
cd "$1"
root=.
compiler=$2
layers="base mesh simplify choice sample particle clump world heap scene study calibrate report"
failed=0
complain() {
  echo "$1"
  failed=1
}

earlier=""
for header in base mesh measure check fracture simplify fidelity choice sample particle clump world joints heap scene study calibrate report; do
  for included in $(sed -n 's/^#include "scree\/\([a-z]*\)\.h"/\1/p' "$root/include/scree/$header.h"); do
    case " $earlier " in
      *" $included "*) ;;
      *) complain "include/scree/$header.h must not include scree/$included.h" ;;
    esac
  done
  grep -q "scree/$header\.h" "$root/include/scree.h" || complain "include/scree.h lacks scree/$header.h"
  earlier="$earlier $header"
done

allowed=""
for layer in $layers; do
  allowed="$allowed $layer"
  # physics knows particles only: world sees no scan, no curve, no choice
  visible=$allowed
  [ "$layer" = world ] && visible="base particle world"
  # a heap is its height field
  [ "$layer" = heap ] && visible="base heap"
  # report reads results through the public header
  [ "$layer" = report ] && visible="base report"
  for file in $(find "$root/src/$layer" -name '*.[ch]'); do
    for included in $(sed -n 's/^ *# *include *"\([a-z_]*\)\/.*/\1/p' "$file" | sort -u); do
      case " $visible " in
        *" $included "*) ;;
        *) complain "${file#"$root"/}: layer $layer must not include $included/" ;;
      esac
    done
  done
done

# The floors of the world climb one way.
visible=""
for floor in state broad contact observe step device; do
  visible="$visible $floor"
  for file in $(find "$root/src/world/$floor" -name '*.[ch]'); do
    for included in $(sed -n 's/^ *# *include *"world\/\([a-z_]*\)\/.*/\1/p' "$file" | sort -u); do
      case " $visible " in
        *" $included "*) ;;
        *) complain "${file#"$root"/}: floor $floor of the world must not include $included/" ;;
      esac
    done
  done
done
for file in "$root"/src/world/*.[ch]; do
  [ ! -e "$file" ] || complain "${file#"$root"/}: a file of the world stands on one of its floors"
done

for folder in src/cli examples bench web/wasm; do
  for file in $(find "$root/$folder" -name '*.[ch]' 2>/dev/null); do
    for included in $(sed -n 's/^ *# *include *"\([^"]*\)".*/\1/p' "$file" | sort -u); do
      case "$folder:$included" in
        *:scree.h | *:scree/*.h | src/cli:cli/* | src/cli:base/* | src/cli:report/provenance.h | src/cli:report/program.h | bench:bench.h | web/wasm:cli/surface.h | \
          web/wasm:scene/file.h | web/wasm:report/program.h | web/wasm:report/page_parts.h | web/wasm:report/provenance.h | web/wasm:report/shapes.h) ;;
        *) complain "${file#"$root"/}: only the public headers are to be seen from $folder, not $included" ;;
      esac
    done
  done
done

system='unistd|fcntl|dirent|sched|spawn|poll|termios|malloc|windows|io|sys\/[a-z]*'
for file in $(grep -lE "^ *# *include *<($system)\.h>" $(find "$root/src" -name "*.[ch]")); do
  case "$file" in
    */src/base/platform_*.c) ;;
    *) complain "${file#"$root"/}: what differs between systems stands in src/base/platform.h" ;;
  esac
done

for name in $(find src include -name '*.h' ! -path '*/vendor/*' | xargs sed -n 's/^} \(scree_[a-z0-9_]*\);$/\1/p' | sort | uniq -d); do
  complain "$name: two types have this name"
done

for header in "$root"/include/scree.h $(find "$root/include/scree" "$root/src" -name '*.h'); do
  echo "#include \"$header\"" |
    "$compiler" -std=c17 -D_POSIX_C_SOURCE=200809L -fsyntax-only -Wall -Wextra -Werror \
      -I"$root/include" -I"$root/src" -x c - || complain "${header#"$root"/}: does not compile alone"
done
exit $failed
