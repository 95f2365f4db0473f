#!/usr/bin/env python3
"""Shortens OpenCV 4.6's universal intrinsics for WebAssembly.

  scripts/wasm/intrinsics.py …/opencv2/core/hal/intrin_wasm.hpp

They were written before WebAssembly's SIMD was final: minima, packing, products of 16-bit numbers and sign masks take up
to 16 instructions where there is one by now. Results are the same, but for v_rshr_pack of 32-bit numbers, which did not
saturate at the lower end. What another version of OpenCV lacks is left as it is, and a line says so.
"""

import argparse
import re
import sys

NARROW = {
    ("u8", "u16"): ("wasm_u8x16_narrow_i16x8", "wasm_u16x8_min({}, wasm_i16x8_splat(255))"),
    ("s8", "s16"): ("wasm_i8x16_narrow_i16x8", "{}"),
    ("u16", "u32"): ("wasm_u16x8_narrow_i32x4", "wasm_u32x4_min({}, wasm_i32x4_splat(65535))"),
    ("s16", "s32"): ("wasm_i16x8_narrow_i32x4", "{}"),
    ("u8", "s16"): ("wasm_u8x16_narrow_i16x8", "{}"),
    ("u16", "s32"): ("wasm_u16x8_narrow_i32x4", "{}"),
}
VECTOR = {
    "u8": "v_uint8x16", "s8": "v_int8x16", "u16": "v_uint16x8", "s16": "v_int16x8", "u32": "v_uint32x4", "s32": "v_int32x4",
}
SCALAR = {"u8": "uchar", "s8": "schar", "u16": "ushort", "s16": "short"}
LANES = {"u8": "i8x16", "s8": "i8x16", "u16": "i16x8", "s16": "i16x8", "u32": "i32x4", "s32": "i32x4"}


def bodies():
    """Pairs of a function's head and its new body."""
    for (to, of), (narrow, clamped) in NARROW.items():
        u = "_u" if (to, of) in (("u8", "s16"), ("u16", "s32")) else ""
        sign = "u" if of[0] == "u" else "i"
        lanes, delta = LANES[of], f"wasm_{LANES[of]}_splat(1 << (n - 1))"

        def shifted(x, sign=sign, lanes=lanes, delta=delta):
            return f"wasm_{sign}{lanes[1:]}_shr(wasm_{lanes}_add({x}.val, {delta}), n)"

        def packed(a, b, narrow=narrow, clamped=clamped):
            return f"{narrow}({clamped.format(a)}, {clamped.format(b)})"

        def stored(a, packed=packed):
            return f"wasm_v128_store64_lane(ptr, {packed(a, a)}, 0);"

        two = f"(const {VECTOR[of]}& a, const {VECTOR[of]}& b)"
        into = f"({SCALAR[to]}* ptr, const {VECTOR[of]}& a)"
        yield f"inline {VECTOR[to]} v_pack{u}{two}", f"return {VECTOR[to]}({packed('a.val', 'b.val')});"
        yield f"inline {VECTOR[to]} v_rshr_pack{u}{two}", f"return {VECTOR[to]}({packed(shifted('a'), shifted('b'))});"
        yield f"inline void v_pack{u}_store{into}", stored("a.val")
        yield f"inline void v_rshr_pack{u}_store{into}", stored(shifted("a"))
    for of, to in (("s16", "s32"), ("u16", "u32")):
        s = "i" if of == "s16" else "u"
        halves = [f"wasm_{s}32x4_extmul_{half}_{s}16x8(a.val, b.val)" for half in ("low", "high")]
        a_b = f"const {VECTOR[of]}& a, const {VECTOR[of]}& b"
        high = "2,3,6,7,10,11,14,15,18,19,22,23,26,27,30,31"
        yield f"inline {VECTOR[of]} v_mul_hi({a_b})", f"return {VECTOR[of]}(wasm_v8x16_shuffle({', '.join(halves)}, {high}));"
        yield (f"inline void v_mul_expand({a_b},\n                         {VECTOR[to]}& c, {VECTOR[to]}& d)",
               f"v128_t low = {halves[0]};\n    d.val = {halves[1]};\n    c.val = low;")
    yield ("inline v_int32x4 v_dotprod(const v_int16x8& a, const v_int16x8& b)",
           "return v_int32x4(wasm_i32x4_dot_i16x8(a.val, b.val));")
    yield "inline v_uint8x16 v_popcount(const v_uint8x16& a)", "return v_uint8x16(wasm_i8x16_popcnt(a.val));"


def texts():
    """Pairs of a text of a macro and its successor."""
    for op in ("min", "max"):
        a, b = ("b", "a") if op == "min" else ("a", "b")
        yield (f"wasm_v128_bitselect({a}.val, {b}.val, wasm_##suffix##_gt(a.val, b.val))", f"wasm_##suffix##_{op}(a.val, b.val)")
        yield (f"""    v128_t delta = wasm_##suffix##_splat(deltaNum); \\
    v128_t mask = wasm_##suffix##_gt(wasm_v128_xor(a.val, delta), wasm_v128_xor(b.val, delta)); \\
    return _Tpvec(wasm_v128_bitselect({a}.val, {b}.val, mask)); \\
""", f"    return _Tpvec(wasm_##suffix##_{op}(a.val, b.val)); \\\n")
    for lanes in ("8x16", "16x8", "32x4"):
        yield f"U_INIT_FUNC(v_uint{lanes}, i{lanes}, ", f"U_INIT_FUNC(v_uint{lanes}, u{lanes}, "
    yield ("""    _Tpvec::lane_type a_[_Tpvec::nlanes]; \\
    wasm_v128_store(a_, a.val); \\
    int mask = 0; \\
    for (int i = 0; i < _Tpvec::nlanes; i++) \\
        mask |= (reinterpret_int(a_[i]) < 0) << i; \\
    return mask; \\
""", "    return (int)wasm_##suffix##_bitmask(a.val); \\\n")
    yield "CHECK_SIGNS(v_float64x2, f64x2, double)", "CHECK_SIGNS(v_float64x2, i64x2, double)"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("header", help="intrin_wasm.hpp; it is changed")
    path = parser.parse_args().header
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for head, body in bodies():
        text, found = re.subn(re.escape(head) + r"\n\{\n.*?\n\}", lambda _, new=f"{head}\n{{\n    {body}\n}}": new, text, count=1, flags=re.S)
        if not found:
            print(f"scripts/wasm/intrinsics.py: not found: {head}", file=sys.stderr)
    for old, new in texts():
        if old not in text:
            print(f"scripts/wasm/intrinsics.py: not found: {old}", file=sys.stderr)
        text = text.replace(old, new)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


main()
