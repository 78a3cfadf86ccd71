// The search of the manual: sections that have any of the words, or words that begin so; those with more of them, and
// with them in their title, first. All of it is in sections.js, so that pages opened from disk can search.
(function () {
  const asked = document.getElementById('asked'), found = document.getElementById('found'), told = document.getElementById('told');
  const escape = (word) => word.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');

  function rank(section, words) {
    let points = 0, had = 0;
    for (const word of words) {
      const begins = new RegExp('(^|[^\\p{L}\\p{N}])' + escape(word), 'giu');
      const inTitle = (section[1].match(begins) || []).length, inText = (section[2].match(begins) || []).length;
      if (inTitle + inText > 0) had++;
      points += 8 * Math.min(inTitle, 1) + Math.log2(1 + inText);
    }
    return had * 100 + points;
  }

  // The words round the first that was asked for.
  function excerpt(text, words) {
    const places = words.map((word) => text.toLowerCase().indexOf(word.toLowerCase())).filter((at) => at >= 0);
    const start = places.length ? Math.max(0, Math.min(...places) - 60) : 0;
    return (start > 0 ? '... ' : '') + text.substring(start, start + 240) + (start + 240 < text.length ? ' ...' : '');
  }

  function show() {
    const words = asked.value.split(/[^\p{L}\p{N}_.-]+/u).filter((word) => word.length > 1);
    const hits = screeSections.map((section) => [rank(section, words), section]).filter(([points]) => points > 0)
      .sort((a, b) => b[0] - a[0]).slice(0, 40);
    told.textContent = !words.length ? '' : hits.length ? hits.length + (hits.length === 40 ? ' best' : '') + ' sections' : 'Nothing found.';
    found.textContent = '';
    for (const [, [url, title, text]] of hits) {
      const item = found.appendChild(document.createElement('li')), link = item.appendChild(document.createElement('a'));
      link.href = url;
      link.textContent = title;
      item.appendChild(document.createElement('p')).textContent = excerpt(text, words);
    }
  }

  asked.value = new URLSearchParams(window.location.search).get('q') || '';
  asked.addEventListener('input', show);
  asked.focus();
  show();
})();
