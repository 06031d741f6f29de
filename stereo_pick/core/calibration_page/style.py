"""How the page looks, on screens and on paper."""

from __future__ import annotations

CSS = """
body { color: #1a1a1a; background: #fff; font: 16px/1.5 system-ui, "Liberation Sans", Arial, sans-serif;
  max-width: 60rem; margin: 0 auto; padding: 1rem; }
h1 { font-size: 1.6rem; margin: 0 0 .5rem; }
h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; border-bottom: 1px solid #767676; }
p, figcaption { max-width: 48rem; }
.verdict { border: 2px solid #1a1a1a; border-left-width: .75rem; padding: .5rem 1rem; }
.verdict strong { font-size: 1.4rem; }
.good { border-color: #00663d; } .usable { border-color: #8a5a00; } .refused { border-color: #a80000; }
table { border-collapse: collapse; margin: .75rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding-bottom: .25rem; }
@media (min-width: 40rem) { caption { white-space: nowrap; } }
th, td { border: 1px solid #999; padding: .2rem .6rem; text-align: right; }
th[scope=row], .reason { text-align: left; font-weight: normal; }
th[scope=row] { min-width: 5rem; overflow-wrap: anywhere; }
.state { text-align: left; white-space: nowrap; }
.table { overflow-x: auto; }
thead th { background: #eee; text-align: center; }
figure { margin: .75rem 0; }
figcaption { font-size: .9rem; }
.row { display: flex; flex-wrap: wrap; gap: .5rem; }
.row svg { min-width: 0; }
svg.bar { display: block; width: 12rem; height: 1.5rem; }
@media print {
  h2 { break-after: avoid; }
  body { max-width: none; padding: 0; font-size: 10pt; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .table { overflow: visible; }
  figure, tr, .verdict { break-inside: avoid; }
}
"""
