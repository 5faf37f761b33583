"""Style sheet of the matrix report: light and dark, on screen and on paper."""

__all__ = ["STYLE"]

STYLE = """
:root{--ink:#1b1d21;--dim:#5c636e;--line:#d9dde3;--back:#fff;--soft:#f5f6f8;--pass:#1a7f37;--fail:#c62828;--open:#a15c00;--none:#6b7280;--tint:90%}
@media (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--dim:#9aa3ae;--line:#363b43;--back:#15171a;--soft:#1e2125;--pass:#4cc26a;--fail:#ff7b72;--open:#e3a03f;--none:#8b949e;--tint:25%}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:76rem;padding:1.5rem;color:var(--ink);background:var(--back);font:15px/1.5 system-ui,sans-serif;overflow-wrap:anywhere}
h1{font-size:1.6rem;margin:.2rem 0}h2{font-size:1.2rem;margin:2rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}h3{font-size:1rem;margin:1rem 0 .4rem}
.dim{color:var(--dim)}code,.id{font-family:ui-monospace,monospace;font-size:.86em}
.verdict{display:inline-block;padding:.25rem .8rem;border:2px solid currentColor;border-radius:.4rem;font-weight:700;font-size:1.1rem}
.pass{color:var(--pass)}.fail{color:var(--fail)}.unverified{color:var(--open)}.not_applicable{color:var(--none)}
.accepted{color:var(--pass)}.incomplete{color:var(--open)}.refused{color:var(--fail)}
blockquote{margin:.6rem 0;padding:.5rem 1rem;border-left:4px solid var(--line);background:var(--soft);white-space:pre-wrap}
.read{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,26rem);gap:1.5rem;align-items:start}
.read blockquote{font-size:1.15rem;line-height:1.9;unicode-bidi:plaintext;text-align:start}
.read aside{position:sticky;top:1rem;border:1px solid var(--line);border-radius:.3rem;padding:.7rem .9rem;min-height:20rem}
.note,.shown{display:none}.note p,.shown figure{margin:0 0 .5rem}.note .n{font-variant-numeric:tabular-nums}
.read:not(:has(mark:hover,mark:focus)) .first{display:block}
mark{background:hsl(var(--hue,0) var(--full,0%) var(--tint));color:var(--ink);border-radius:.2rem;padding:.05em .15em;text-decoration:underline .12em;text-decoration-skip-ink:none;text-underline-offset:.22em;box-decoration-break:clone;-webkit-box-decoration-break:clone}
mark[tabindex]{cursor:help}mark:focus-visible{outline:2px solid var(--ink);outline-offset:2px}
mark[data-sign]::after{content:attr(data-sign);font-size:.6em;vertical-align:super;margin-inline:.25em;unicode-bidi:isolate;direction:ltr;white-space:nowrap}
.s-pass{text-decoration-color:var(--pass)}.s-fail{text-decoration-style:wavy;text-decoration-color:var(--fail)}
.s-unverified{text-decoration-style:dashed;text-decoration-color:var(--open)}.s-reading{text-decoration-style:dotted;text-decoration-color:var(--dim)}
.s-waived{text-decoration-style:double;text-decoration-color:var(--dim)}
.filler{color:var(--dim)}
.t-thing{--hue:212}.t-count{--hue:185}.t-quantity{--hue:160}.t-property{--hue:272}.t-event{--hue:30}.t-order{--hue:52}.t-negation{--hue:0}
.t-place{--hue:125}.t-route{--hue:90}.t-time{--hue:240}.t-weather{--hue:195}.t-look{--hue:320}[class^=t-]:not(.t-other){--full:75%}
.legend [class^=t-]{text-decoration:none}.legend{list-style:none;padding:0;display:flex;flex-wrap:wrap;gap:.3rem 1rem;font-size:.9em}
@supports not selector(:has(a)){.note{display:block}}
@media (max-width:56rem){.read{grid-template-columns:minmax(0,1fr)}.read aside{position:static;min-height:0}}
@media print{.read{display:block}.read .note{display:block}.read .shown:not(.first){display:none}}
table{border-collapse:collapse;width:100%;margin:.4rem 0}th,td{text-align:left;vertical-align:top;padding:.3rem .5rem;border-bottom:1px solid var(--line)}
ul,ol{margin:.2rem 0;padding-left:1.3rem}
th{white-space:nowrap;color:var(--dim);font-weight:600;font-size:.85em}td.n{white-space:nowrap;overflow-wrap:normal;font-variant-numeric:tabular-nums}
.scroll{overflow-x:auto}
details{margin:.15rem 0}summary{cursor:pointer;color:var(--dim)}pre{max-width:46rem;white-space:pre-wrap;background:var(--soft);padding:.5rem;margin:.3rem 0;font-size:.82em}
figure{margin:.6rem 0}img{max-width:100%;height:auto;border:1px solid var(--line);border-radius:.3rem;background:#fff}figcaption{color:var(--dim);font-size:.88em}
.card{border:1px solid var(--line);border-left:4px solid var(--fail);border-radius:.3rem;padding:.6rem .9rem;margin:.7rem 0}
.card.unverified{border-left-color:var(--open);color:inherit}.card.fail{color:inherit}
.bar{position:relative;height:1.5rem;background:var(--soft);border:1px solid var(--line);border-radius:.2rem;min-width:16rem}
.bar span{position:absolute;top:0;bottom:0;background:currentColor;opacity:.4;min-width:3px}
.bar i{position:absolute;top:-3px;bottom:-3px;width:3px;background:var(--ink)}
@media print{body{max-width:none;padding:0;font-size:11px}.card,figure,tr{break-inside:avoid}}
"""
