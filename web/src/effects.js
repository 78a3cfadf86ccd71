// What each factor of a study does to an answer: main effects and interactions of two, by least squares on factors coded
// from -1 (their lowest value) to 1 (their highest), as of a factorial design (Box, Hunter and Hunter 2005, chapter 5).

// Solves a x = b for several right-hand sides by elimination with pivots; null where the columns are not independent.
function solve(a, b) {
  const n = a.length, m = a.map((row, i) => [...row, ...b[i]]);
  for (let k = 0; k < n; k++) {
    const pivot = m.reduce((best, row, i) => (i >= k && Math.abs(row[k]) > Math.abs(m[best][k]) ? i : best), k);
    if (Math.abs(m[pivot][k]) < 1e-9) return null;
    [m[k], m[pivot]] = [m[pivot], m[k]];
    for (let i = 0; i < n; i++) {
      if (i === k) continue;
      const factor = m[i][k] / m[k][k];
      for (let j = k; j < m[i].length; j++) m[i][j] -= factor * m[k][j];
    }
  }
  return m.map((row, i) => row.slice(n).map((x) => x / row[i]));
}

// A factor's values as numbers from -1 to 1; null where it does not vary, or has more than two values that are no numbers.
function coded(name, points) {
  const values = points.map(({ factors }) => factors[name]), levels = [...new Set(values)];
  if (levels.length < 2) return null;
  if (levels.every((v) => typeof v === 'number')) {
    const scale = name === 'rp' ? Math.log : Number; // as it is drawn
    const low = Math.min(...levels), high = Math.max(...levels);
    return { name, from: low, to: high, at: values.map((v) => (2 * (scale(v) - scale(low))) / (scale(high) - scale(low)) - 1) };
  }
  return levels.length === 2 ? { name, from: levels[0], to: levels[1], at: values.map((v) => (v === levels[0] ? -1 : 1)) } : null;
}

// [{name, from, to, effect, error}]: how much the answer grows from one end to the other, and the standard error of that
// from the replicates' scatter (null without). Empty for fewer than two factors, or fewer points than effects.
export function effects(allPoints, get) {
  const points = allPoints.filter((p) => Number.isFinite(get(p)?.mean));
  const factors = Object.keys(points[0]?.factors ?? {}).map((name) => coded(name, points)).filter(Boolean);
  if (factors.length < 2) return [];
  const pairs = factors.flatMap((a, i) => factors.slice(i + 1).map((b) => ({ name: `${a.name} with ${b.name}`, at: a.at.map((x, k) => x * b.at[k]) })));
  const fit = (terms) => {
    const columns = [points.map(() => 1), ...terms.map(({ at }) => at)];
    if (points.length < columns.length) return null;
    const dot = (x, y) => x.reduce((sum, v, i) => sum + v * y[i], 0);
    const y = points.map((p) => get(p).mean);
    const square = columns.map((x) => columns.map((z) => dot(x, z)));
    return solve(square, columns.map((x, i) => [dot(x, y), ...columns.map((_, j) => (i === j ? 1 : 0))]));
  };
  const withPairs = fit([...factors, ...pairs]), terms = withPairs ? [...factors, ...pairs] : factors, found = withPairs ?? fit(factors);
  if (!found) return [];
  const scattered = points.map(get).filter((s) => s.count > 1 && Number.isFinite(s.sd));
  const variance = scattered.length ? scattered.reduce((sum, s) => sum + (s.sd * s.sd) / s.count, 0) / scattered.length : null; // of a point's mean
  return terms.map(({ name, from, to }, k) => ({
    name, from, to, effect: 2 * found[k + 1][0], error: variance === null ? null : 2 * Math.sqrt(variance * found[k + 1][k + 2]),
  }));
}
