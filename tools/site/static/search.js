// The search of the manual, by lunr: sections that have any of the words, their stems, words that begin so or differ by a
// letter or two; nearer ones first. All of it is in sections.js, so that pages opened from disk can search.
(function () {
  // What people ask for by another word than the manual's.
  const SYNONYMS = {
    licence: ['license'], moisture: ['cohesion'], wet: ['cohesion'], humidity: ['cohesion'], sticky: ['cohesion'], blender: ['mixer', 'export'],
    inch: ['unit'], inches: ['unit', 'inch'], feet: ['unit'], polygon: ['triangle'], faces: ['triangles'], facets: ['triangles'],
    reduce: ['simplify'], decimate: ['simplify'], collider: ['particle'], silo: ['hopper'], bin: ['hopper'], screen: ['sieve'], sieve: ['screen'],
    multisphere: ['clump'], breakage: ['fracture', 'joints'], crush: ['fracture', 'joints'], gpu: ['cuda'], cluster: ['slurm'], fit: ['calibrate'],
    tune: ['calibrate'], optimize: ['optimise'], meshlab: ['quadric'], watertight: ['closed'], rotation: ['spin'], humid: ['cohesion'],
  };
  const asked = document.getElementById('asked'), found = document.getElementById('found'), told = document.getElementById('told');
  const index = lunr(function () {
    this.ref('number');
    this.field('title', {boost: 6});
    this.field('text');
    screeSections.forEach(([, title, text], number) => this.add({number, title, text}));
  });

  // Words of five letters may have one that is wrong, of nine two.
  function ask(words) {
    return index.query((query) => {
      const add = (word, boost) => {
        query.term(lunr.stemmer(new lunr.Token(word)).toString(), {boost, usePipeline: false});
        query.term(word, {boost: boost / 3, usePipeline: false, wildcard: lunr.Query.wildcard.TRAILING});
      };
      for (const word of words) {
        add(word, 12);
        for (const other of SYNONYMS[word] || []) add(other, 4);
        if (word.length > 4) query.term(word, {boost: .3, usePipeline: false, editDistance: word.length > 8 ? 2 : 1});
      }
    });
  }

  // The words round the first that was asked for.
  function excerpt(text, words) {
    const places = words.map((word) => text.toLowerCase().indexOf(word)).filter((at) => at >= 0);
    const start = places.length ? Math.max(0, Math.min(...places) - 60) : 0;
    return (start > 0 ? '... ' : '') + text.substring(start, start + 240) + (start + 240 < text.length ? ' ...' : '');
  }

  function show() {
    const words = asked.value.toLowerCase().split(/[^\p{L}\p{N}_.-]+/u).filter((word) => word.length > 1);
    const hits = words.length ? ask(words).slice(0, 40) : [];
    told.textContent = !words.length ? '' : hits.length ? hits.length + (hits.length === 40 ? ' best' : '') + ' sections' : 'Nothing found.';
    found.textContent = '';
    for (const hit of hits) {
      const [url, title, text] = screeSections[hit.ref];
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
