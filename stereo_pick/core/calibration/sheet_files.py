"""A sheet as SVG or PDF: vectors in true size."""

from __future__ import annotations

from stereo_pick.core.calibration.sheet import TEXT_MM, Sheet

_POINTS_PER_MM = 72 / 25.4


def svg(sheet: Sheet) -> bytes:
    """The sheet as SVG, one unit a millimetre."""
    size = f'{_number(sheet.width_mm)}mm" height="{_number(sheet.height_mm)}mm'
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" '
        f'viewBox="0 0 {_number(sheet.width_mm)} {_number(sheet.height_mm)}" shape-rendering="crispEdges">',
        '<rect width="100%" height="100%" fill="white"/>',
        '<g fill="black">',
    ]
    for rectangle in sheet.rectangles_mm:
        x, y, width, height = map(_number, rectangle)
        lines.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}"/>')
    lines.append(f'</g><g font-family="Helvetica, Arial, sans-serif" font-size="{TEXT_MM:g}">')
    lines += [f'<text x="{_number(t.x_mm)}" y="{_number(t.y_mm)}">{_xml(t.text)}</text>' for t in sheet.texts]
    return "\n".join([*lines, "</g></svg>", ""]).encode()


def pdf(sheet: Sheet) -> bytes:
    """The sheet as a PDF of one page (PDF 1.4), which asks viewers not to scale it."""
    size = " ".join(_number(mm * _POINTS_PER_MM) for mm in (sheet.width_mm, sheet.height_mm))
    content = _content(sheet)
    return _document(
        [
            b"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
            b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
            f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {size}] /Contents 4 0 R "
            "/Resources << /Font << /F1 5 0 R >> >> >>".encode(),
            b"<< /Length %d >>\nstream\n%s\nendstream" % (len(content), content),
            b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        ]
    )


def _content(sheet: Sheet) -> bytes:
    """Drawing in millimetres, y up; all rectangles are one path, since apart they would show seams."""
    lines = [f"{_POINTS_PER_MM:.8f} 0 0 {_POINTS_PER_MM:.8f} 0 0 cm", "0 g"]
    for x, y, width, height in sheet.rectangles_mm:
        lines.append(" ".join(map(_number, (x, sheet.height_mm - y - height, width, height))) + " re")
    lines.append("f")
    for text in sheet.texts:
        place = f"{_number(text.x_mm)} {_number(sheet.height_mm - text.y_mm)} Td"
        lines.append(f"BT /F1 {TEXT_MM:g} Tf {place} ({_pdf(text.text)}) Tj ET")
    return "\n".join(lines).encode("ascii")


def _document(objects: list[bytes]) -> bytes:
    """Number the objects from 1, the first being the catalogue, and add the table of where each begins."""
    document, starts = b"%PDF-1.4\n", list[int]()
    for number, body in enumerate(objects, start=1):
        starts.append(len(document))
        document += b"%d 0 obj\n%s\nendobj\n" % (number, body)
    table = b"".join(b"%010d 00000 n \n" % start for start in starts)
    return document + (
        b"xref\n0 %d\n0000000000 65535 f \n%strailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n"
        % (len(objects) + 1, table, len(objects) + 1, len(document))
    )


def _number(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _xml(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _pdf(text: str) -> str:
    return text.replace("\\", "\\\\").replace("(", "\\(").replace(")", "\\)")
