/**
 * Of each point whether none other is at least as good in both and better in one; smaller is better. As paretoFront in
 * framework/chart/axes.cpp: both are tested against tests/chart/pareto_cases.json.
 * @param {{x: number, y: number}[]} points
 * @returns {boolean[]}
 */
export function paretoFront(points) {
  const order = points.map((_, i) => i).sort((a, b) => points[a].x - points[b].x || points[a].y - points[b].y || a - b);
  const front = points.map(() => false);
  let last;
  for (const i of order) {
    const p = points[i];
    const same = last && last.x === p.x && last.y === p.y;
    if (last && !same && p.y >= last.y) continue;
    front[i] = true;
    last = p;
  }
  return front;
}
