#!/bin/sh
# codespell over what people read: the manual, the headers, the program's texts. usage: spelling.sh ROOT
command -v codespell >/dev/null || { echo "no codespell"; exit 77; }
cd "$1" && codespell --ignore-words-list statics,buss,fro,siz,nd,te,ot,trough,acces,symetric README.md CONTRIBUTING.md CHANGELOG.md docs include src python/scree web/src \
  tools/*.sh --skip '*.png,*.inc,*.pyc'
