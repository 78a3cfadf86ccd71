#!/bin/sh
# Makes the pictures of the manual again, in docs/figures/, by the program as it is built.
# usage: figures.sh BUILD_FOLDER [NAME...]      without names those of minutes: tutorials levels report browser
# choice takes two minutes, paper an hour, study a night; report and browser need chromium, browser `make page`
set -eu
build=$(realpath "$1")
shift
top=$(realpath "$(dirname "$0")/..")
figures=$top/docs/figures
scree=$build/bin/scree
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
for name in ${*:-tutorials levels report browser}; do
  case $name in
  tutorials)
    for page in scan-to-dem angle-of-repose own-machine photograph; do
      UPDATE=1 /usr/bin/python3 "$top/tests/docs/run_page.py" "$scree" "$build/libscree.so" "$top/docs/tutorials/$page.md" --long
    done
    ;;
  levels) "$scree" render sample:dc-1 --rp 1e-1,1e-2,1e-3,1e-4,1e-5 --edges --rays 64 --columns 6 -s 1980x330 -f -o "$figures/levels.png" ;;
  report)
    "$scree" repose --samples --resolution 1mm -p demo -o heap -q --no-picture
    /usr/bin/python3 "$top/tests/page/picture.py" heap/report.html "$figures/report.png"
    ;;
  browser) /usr/bin/python3 "$top/tests/page/picture.py" "$top/build/page/scree.html" "$figures/browser.png" ;;
  choice)
    "$scree" choose --samples -o volume -q && cp volume/figure.png "$figures/choice-samples.png"
    "$scree" choose --samples --paper -o paper -q && cp paper/figure.png "$figures/choice-samples-paper.png"
    ;;
  paper)
    "$scree" repose -c "$top/bench/results/paper/experiment.yaml" --samples --rp 1e-3 -o whole -q --no-picture
    "$scree" pile whole/last.scree -s 1000x700 -f -o "$figures/heap-paper.png"
    ;;
  study)
    "$scree" study "$top/bench/results/study/repose-reduced.yaml" -o study -q
    for of in angle rotation time; do cp "study/$of.png" "$figures/study-$of.png"; done
    ;;
  *) echo "no pictures of that name: $name" >&2 && exit 2 ;;
  esac
done
