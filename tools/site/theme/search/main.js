// In place of MkDocs' own search, whose worker and JSON a browser refuses on pages opened from disk: lunr and the
// index come as scripts.
(function () {
  var index, pages = {};

  function load(name, then) {
    var script = document.createElement('script');
    script.src = base_url + '/search/' + name;
    script.onload = then;
    document.head.appendChild(script);
  }

  function build() {
    index = lunr(function () {
      this.ref('location');
      this.field('title', { boost: 10 });
      this.field('text');
      screeIndex.docs.forEach(function (page) {
        this.add(page);
        pages[page.location] = page;
      }, this);
    });
  }

  // The words round the first one that was asked for.
  function excerpt(page, words) {
    var text = page.text, low = text.toLowerCase(), at = -1;
    words.forEach(function (word) { if (at < 0) at = low.indexOf(word.toLowerCase()); });
    var start = Math.max(0, at - 60);
    return (start > 0 ? '... ' : '') + text.substring(start, start + 240) + (start + 240 < text.length ? ' ...' : '');
  }

  function find(query) {
    var words = query.split(/[^\w.-]+/).filter(Boolean);
    return index.query(function (q) {
      words.forEach(function (word) {
        q.term(word.toLowerCase(), { presence: lunr.Query.presence.REQUIRED, wildcard: lunr.Query.wildcard.TRAILING });
      });
    }).map(function (hit) { return { page: pages[hit.ref], text: excerpt(pages[hit.ref], words) }; });
  }

  function show(query) {
    var list = document.getElementById('mkdocs-search-results');
    list.textContent = '';
    var hits = query.trim().length > 1 ? find(query) : [];
    if (!hits.length) list.appendChild(document.createElement('p')).textContent = 'Nothing found.';
    hits.forEach(function (hit) {
      var item = list.appendChild(document.createElement('article'));
      var link = item.appendChild(document.createElement('h3')).appendChild(document.createElement('a'));
      link.href = base_url + '/' + hit.page.location;
      link.textContent = hit.page.title;
      item.appendChild(document.createElement('p')).textContent = hit.text;
    });
  }

  load('lunr.js', function () {
    load('search_index.js', function () {
      var input = document.getElementById('mkdocs-search-query');
      var list = document.getElementById('mkdocs-search-results');
      var asked = new URLSearchParams(window.location.search).get('q');
      if (!input || !list) return;
      build();
      input.addEventListener('keyup', function () { show(input.value); });
      if (asked) {
        input.value = asked;
        show(asked);
      }
    });
  });
})();
