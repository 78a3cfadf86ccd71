# every option of every verb is in the one table, which is sorted and gives a letter once
"$SCREE" help --options >table && cut -f 1 table >names && LC_ALL=C sort -c names
cut -f 2 table | grep . | sort | uniq -d
tab=$(printf '\t')
for verb in $("$SCREE" help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -v 'help\|version'); do
  "$SCREE" help $verb | sed -n "s/^  -\(.\), --\([a-z-]*\).*/\2$tab-\1/p; s/^      --\([a-z-]*\).*/\1$tab/p" >options
  while IFS= read -r option; do
    grep -q "^$option$tab" table || echo "$verb: not in the table: $option"
  done <options
  cut -f 1 options >>seen
done
# and there are no others in it
LC_ALL=C sort -u seen | comm -13 - names
# pages for man and the site of every verb, and completion that the shells read
for verb in '' $("$SCREE" help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -v 'help\|version'); do
  "$SCREE" help --man $verb | grep -q '^# SYNOPSIS' && "$SCREE" help --markdown $verb | grep -q '^| option' || echo "no page: $verb"
done
run help --man chose 2>&1 | lines 2
for shell in bash zsh fish tcsh; do
  "$SCREE" help --completion $shell >completion 2>&1 || head -n 1 completion
  command -v $shell >/dev/null && [ $shell != tcsh ] && { $shell -n completion || echo "$shell does not read its completion"; }
done
"$SCREE" help --completion bash >completion
bash -c '. ./completion; COMP_WORDS=(scree choose --rule ""); COMP_CWORD=3; _scree; echo ${COMPREPLY[@]}'
bash -c '. ./completion; COMP_WORDS=(scree choo); COMP_CWORD=1; _scree; echo ${COMPREPLY[@]}'
# values are offered where they are words, templates and samples among them
complete() { bash -c '. ./completion; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _scree; echo ${COMPREPLY[@]}' sh "$@" | cut -c1-60; }
complete scree run --template d
complete scree export x --to l
complete scree repose -p ''
complete scree choose -u ''
complete scree choose sample : fp
