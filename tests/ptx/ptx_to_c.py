#!/usr/bin/env python3
"""PTX, as LLVM writes it, to C: the very instructions of the kernels, run on the processor.

usage: ptx_to_c.py IN.ptx OUT.c

Each function becomes a C function F_NAME of pointers to its result and parameters; each register a
variable; each instruction one statement. Double operations must be rounded to nearest (.rn). Whatever is
not known here is an error. Compile the result with -fwrapv -fno-strict-aliasing -ffp-contract=off.
"""
import re
import sys

TYPES = {
    "f64": "double", "f32": "float", "pred": "int",
    **{f"{kind}{bits}": f"{'int' if kind == 's' else 'uint'}{bits}_t"
       for kind in "usb" for bits in (8, 16, 32, 64)},
}
SPECIAL = {"%ctaid.x": "block_index", "%nctaid.x": "block_count", "%ntid.x": "block_size",
           "%tid.x": "thread_index", "%ctaid.y": "world_index"}
COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
UNORDERED = {"equ": "==", "neu": "!=", "ltu": "<", "leu": "<=", "gtu": ">", "geu": ">="}

PRELUDE = """/* Made from PTX. */
#include <stdint.h>
#include <string.h>
extern int watching;
void note_access(const void *at, uint64_t size, int is_write);
_Thread_local uint32_t thread_index, block_index, block_size = 1, block_count = 1, world_index;
static inline double of_bits(uint64_t b) { double d; memcpy(&d, &b, 8); return d; }
static inline float of_bits_f(uint32_t b) { float d; memcpy(&d, &b, 4); return d; }
static inline uint64_t bits_of(double d) { uint64_t b; memcpy(&b, &d, 8); return b; }
static inline double larger(double a, double b) {
  if (a != a) return b;
  if (b != b) return a;
  if (a == b) return bits_of(a) >> 63 ? b : a;
  return a > b ? a : b;
}
static inline double lesser(double a, double b) {
  if (a != a) return b;
  if (b != b) return a;
  if (a == b) return bits_of(a) >> 63 ? a : b;
  return a < b ? a : b;
}
static inline uint32_t fetch_min(uint32_t *at, uint32_t v) {
  uint32_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (v < old && !__atomic_compare_exchange_n(at, &old, v, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
  return old;
}
static inline uint64_t fetch_max64(uint64_t *at, uint64_t v) {
  uint64_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (v > old && !__atomic_compare_exchange_n(at, &old, v, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
  return old;
}
static inline uint32_t fetch_max(uint32_t *at, uint32_t v) {
  uint32_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (v > old && !__atomic_compare_exchange_n(at, &old, v, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
  return old;
}
"""


def fail(what):
    sys.exit(f"ptx_to_c.py: {what}")


def split(text):
    """At the commas outside brackets."""
    parts, depth, part = [], 0, ""
    for c in text:
        depth += (c in "{[(") - (c in "}])")
        if c == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += c
    return parts + [part.strip()] if part.strip() else parts


def register(name):
    return name[1:].replace(".", "_").replace("$", "_")


class Translator:
    def __init__(self, text):
        self.text = re.sub(r"//[^\n]*", "", text)
        self.globals = {}
        self.functions = []  # (kind, name, has result, parameter count, body or None)

    # ---- operands ----

    def operand(self, text, type_):
        if text in SPECIAL:
            return SPECIAL[text]
        if text.startswith("%"):
            name = register(text)
            if name.startswith(("fd", "f", "p")) and not name.startswith("pr"):
                return name
            return f"({TYPES[type_]}){name}" if type_ in TYPES and type_ != "pred" else name
        m = re.fullmatch(r"0d([0-9A-F]{16})", text)
        if m:
            return f"of_bits(0x{m[1]}u)"
        m = re.fullmatch(r"0f([0-9A-F]{8})", text)
        if m:
            return f"of_bits_f(0x{m[1]}u)"
        if re.fullmatch(r"-?\d+", text):
            if text == "-9223372036854775808":
                return "INT64_MIN"
            return f"(({TYPES[type_]}){text}{'ll' if type_[1:] == '64' else ''})"
        if text in self.globals:
            return f"(uint64_t)G_{text}"
        if re.fullmatch(r"__local_depot\d+", text):
            return f"(uint64_t){text}"
        fail(f"operand {text}")

    def address(self, text):
        m = re.fullmatch(r"\[([^\]+]+)(?:\+(-?\d+))?\]", text)
        if not m:
            fail(f"address {text}")
        base, offset = m[1], m[2] or "0"
        if base.startswith("%"):
            return f"(char *){register(base)} + ({offset})"
        return f"(char *){'G_' if base in self.globals else ''}{base} + ({offset})"

    # ---- instructions ----

    def instruction(self, op, args):
        parts = op.split(".")
        handler = getattr(self, "do_" + parts[0], None)
        if not handler:
            fail(f"unknown instruction {op} {', '.join(args)}")
        return handler(parts, args)

    def set(self, args, value):
        return f"{register(args[0])} = {value};"

    def do_mov(self, p, a):
        if p[-1] == "pred":
            return self.set(a, {"-1": "1", "1": "1", "0": "0"}.get(a[1]) or register(a[1]))
        if p[-1] == "b64" and a[0].startswith("%rd") and a[1].startswith("%fd"):
            return self.set(a, f"bits_of({register(a[1])})")
        if p[-1] == "b64" and a[0].startswith("%fd") and a[1].startswith("%rd"):
            return self.set(a, f"of_bits({register(a[1])})")
        return self.set(a, self.operand(a[1], p[-1]))

    def check_access(self, p):
        if not set(p[1:-1]) <= {"param", "global", "local", "const", "v2", "v4", "nc"}:
            fail("access " + ".".join(p))

    def noted(self, p, at, count, is_write):
        """A call that tells the stand-in of an access to the device's memory."""
        if "param" in p or "local" in p or "const" in p:
            return ""
        return f"if (watching) note_access({at}, {count} * sizeof({TYPES[p[-1]]}), {int(is_write)}); "

    def do_ld(self, p, a):
        self.check_access(p)
        type_, at = TYPES[p[-1]], self.address(a[1])
        if not a[0].startswith("{"):
            return self.noted(p, at, 1, False) + self.set(a, f"*({type_} *)({at})")
        names = [register(x.strip()) for x in a[0].strip("{}").split(",")]
        return self.noted(p, at, len(names), False) + f"{type_} *at = ({type_} *)({at}); " + " ".join(
            f"{type_} v{k} = at[{k}];" for k in range(len(names))) + " " + " ".join(
            f"{n} = v{k};" for k, n in enumerate(names))

    def do_st(self, p, a):
        self.check_access(p)
        values = [x.strip() for x in a[1].strip("{}").split(",")]
        return self.noted(p, self.address(a[0]), len(values), True) + " ".join(f"(({TYPES[p[-1]]} *)({self.address(a[0])}))[{k}] = {self.operand(v, p[-1])};"
                        for k, v in enumerate(values))

    def rounded(self, p):
        if p[1:-1] != ["rn"]:
            fail("not rounded to nearest: " + ".".join(p))

    def arithmetic(self, p, a, sign):
        x, y = self.operand(a[1], p[-1]), self.operand(a[2], p[-1])
        if p[-1] in ("f64", "f32"):
            self.rounded(p)
            return self.set(a, f"{x} {sign} {y}")
        if p[1:-1]:
            fail(".".join(p))
        return self.set(a, f"({TYPES[p[-1]]})({x} {sign} {y})")

    def do_add(self, p, a):
        return self.arithmetic(p, a, "+")

    def do_sub(self, p, a):
        return self.arithmetic(p, a, "-")

    def do_div(self, p, a):
        return self.arithmetic(p, a, "/")

    def do_rem(self, p, a):
        return self.arithmetic(p, a, "%")

    def do_rcp(self, p, a):
        self.rounded(p)
        return self.set(a, f"1.0 / {self.operand(a[1], p[-1])}")

    def do_sqrt(self, p, a):
        self.rounded(p)
        return self.set(a, f"__builtin_sqrt({self.operand(a[1], p[-1])})")

    WIDE = {"u32": "uint64_t", "s32": "int64_t", "u16": "uint32_t", "s16": "int32_t"}

    def do_mul(self, p, a):
        if p[-1] in ("f64", "f32"):
            return self.arithmetic(p, a, "*")
        x, y = self.operand(a[1], p[-1]), self.operand(a[2], p[-1])
        if p[1] == "wide":
            w = self.WIDE[p[-1]]
            return self.set(a, f"({w}){x} * ({w}){y}")
        if p[1] == "hi" and p[-1] in ("u64", "u32", "s64", "s32"):
            bits = int(p[-1][1:])
            w = ("unsigned " if p[-1][0] == "u" else "") + "__int128"
            return self.set(a, f"({TYPES[p[-1]]})((({w}){x} * ({w}){y}) >> {bits})")
        if p[1] != "lo":
            fail(".".join(p))
        return self.set(a, f"({TYPES[p[-1]]})({x} * {y})")

    def do_mad(self, p, a):
        x, y = self.operand(a[1], p[-1]), self.operand(a[2], p[-1])
        if p[1] == "wide":
            w = self.WIDE[p[-1]]
            return self.set(a, f"({w}){x} * ({w}){y} + ({w}){self.operand(a[3], p[-1][0] + '64')}")
        if p[1] != "lo":
            fail(".".join(p))
        return self.set(a, f"({TYPES[p[-1]]})({x} * {y} + {self.operand(a[3], p[-1])})")

    def do_abs(self, p, a):
        if p[-1] != "f64":
            fail(".".join(p))
        return self.set(a, f"__builtin_fabs({self.operand(a[1], p[-1])})")

    def do_neg(self, p, a):
        return self.set(a, f"-{self.operand(a[1], p[-1])}")

    def extreme(self, p, a, name, sign):
        x, y = self.operand(a[1], p[-1]), self.operand(a[2], p[-1])
        if p[-1] == "f64" and len(p) == 2:
            return self.set(a, f"{name}({x}, {y})")
        if p[-1][0] not in "us":
            fail(".".join(p))
        return self.set(a, f"{x} {sign} {y} ? {x} : {y}")

    def do_min(self, p, a):
        return self.extreme(p, a, "lesser", "<")

    def do_max(self, p, a):
        return self.extreme(p, a, "larger", ">")

    def bitwise(self, p, a, sign):
        return self.set(a, f"{self.operand(a[1], p[-1])} {sign} {self.operand(a[2], p[-1])}")

    def do_and(self, p, a):
        return self.bitwise(p, a, "&")

    def do_or(self, p, a):
        return self.bitwise(p, a, "|")

    def do_xor(self, p, a):
        return self.bitwise(p, a, "^")

    def do_not(self, p, a):
        return self.set(a, f"{'!' if p[-1] == 'pred' else '~'}{self.operand(a[1], p[-1])}")

    def do_shl(self, p, a):
        return self.shift(p, a, "<<")

    def do_shr(self, p, a):
        return self.shift(p, a, ">>")

    def shift(self, p, a, sign):
        bits, x, by = int(p[-1][1:]), self.operand(a[1], p[-1]), self.operand(a[2], "u32")
        gone = f"({TYPES[p[-1]]})({x} >> {bits - 1})" if p[-1][0] == "s" else "0"
        return self.set(a, f"{by} >= {bits} ? {gone} : ({TYPES[p[-1]]})({x} {sign} {by})")

    def do_bfe(self, p, a):
        if p[-1] not in ("u32", "u64"):
            fail(".".join(p))
        return self.set(a, f"({self.operand(a[1], p[-1])} >> {self.operand(a[2], 'u32')}) & "
                           f"((1ull << {self.operand(a[3], 'u32')}) - 1)")

    def do_selp(self, p, a):
        return self.set(a, f"{register(a[3])} ? {self.operand(a[1], p[-1])} : {self.operand(a[2], p[-1])}")

    def do_setp(self, p, a):
        if len(p) != 3:
            fail(".".join(p))
        x, y, how = self.operand(a[1], p[-1]), self.operand(a[2], p[-1]), p[1]
        if p[-1] not in ("f64", "f32"):
            how = {"lo": "lt", "ls": "le", "hi": "gt", "hs": "ge"}.get(how, how)
            return self.set(a, f"{x} {COMPARISONS[how]} {y}")
        if how in ("num", "nan"):
            return self.set(a, f"{'!' if how == 'num' else ''}__builtin_isunordered({x}, {y})")
        if how == "ne":
            return self.set(a, f"({x} < {y} || {x} > {y})")
        if how in COMPARISONS:
            return self.set(a, f"{x} {COMPARISONS[how]} {y}")
        if how == "neu":
            return self.set(a, f"{x} != {y}")
        return self.set(a, f"(__builtin_isunordered({x}, {y}) || {x} {UNORDERED[how]} {y})")

    def do_cvta(self, p, a):
        return self.set(a, self.operand(a[1], "u64"))

    def do_cvt(self, p, a):
        to, from_ = p[-2], p[-1]
        x = self.operand(a[1], from_)
        if to == from_ == "f64" and p[1:-2] in (["rmi"], ["rpi"], ["rzi"]):
            name = {"rmi": "floor", "rpi": "ceil", "rzi": "trunc"}[p[1]]
            return self.set(a, f"__builtin_{name}({x})")
        if "f64" in (to, from_) or "f32" in (to, from_):
            exact = to == "f64" and from_ == "f32"
            whole = to[0] in "us" and p[1:-2] == ["rzi"]
            if not (exact or whole or p[1:-2] == ["rn"]):
                fail(".".join(p))
        elif p[1:-2]:
            fail(".".join(p))
        return self.set(a, f"({TYPES[to]}){x}")

    def do_atom(self, p, a):
        names = [x for x in p[1:] if x not in ("global", "relaxed", "gpu")]
        at, value = self.address(a[1]), self.operand(a[2], p[-1])
        if names in (["add", "u64"], ["add", "u32"], ["add", "s32"], ["add", "s64"]):
            return self.set(a, f"__atomic_fetch_add(({TYPES[p[-1]]} *)({at}), {value}, __ATOMIC_RELAXED)")
        if names == ["exch", "b64"]:
            return self.set(a, f"__atomic_exchange_n((uint64_t *)({at}), {value}, __ATOMIC_RELAXED)")
        if names in (["and", "b64"], ["or", "b64"], ["or", "b32"]):
            return self.set(a, f"__atomic_fetch_{names[0]}(({TYPES[p[-1]]} *)({at}), {value}, __ATOMIC_RELAXED)")
        if names == ["max", "u64"]:
            return self.set(a, f"fetch_max64((uint64_t *)({at}), {value})")
        if names in (["min", "u32"], ["max", "u32"]):
            return self.set(a, f"fetch_{names[0]}((uint32_t *)({at}), {value})")
        fail(".".join(p))

    # ---- functions ----

    def declaration(self, statement):
        m = re.fullmatch(r"\.reg \.(\w+) (%\w+)(?:<(\d+)>)?", statement)
        if m:
            names = ([f"{m[2][1:]}{k}" for k in range(1, int(m[3]))] if m[3] else [m[2][1:]])
            return f"{TYPES[m[1]]} {', '.join(n + ' = 0' for n in names)};" if names else ""
        m = re.fullmatch(r"\.local \.align (\d+) \.b8 (\w+)\[(\d+)\]", statement)
        if m:
            return f"_Alignas(16) char {m[2]}[{m[3]}];"
        m = re.fullmatch(r"\.param (?:\.align \d+ )?\.\w+ (\w+)(?:\[(\d+)\])?", statement)
        if m:
            return f"uint64_t {m[1]}[{(int(m[2] or 8) + 7) // 8}];"
        if statement.startswith(".pragma") or statement == ".reg .b32 temp_param_reg":
            return ""
        fail(f"directive {statement}")

    def statement(self, text):
        if text in "{}":
            return text
        if text.endswith(":"):
            return f"{text.replace('$', '_')} ;"
        if text.startswith("."):
            return self.declaration(text)
        guard = ""
        m = re.match(r"@(!?)%(p\d+) (.*)", text)
        if m:
            guard, text = f"if ({m[1]}{m[2]}) ", m[3]
        if text == "ret":
            return guard + "return;"
        m = re.fullmatch(r"bra(?:\.uni)? ([\w$]+)", text)
        if m:
            return f"{guard}goto {m[1].replace('$', '_')};"
        m = re.fullmatch(r"call(?:\.uni)? (?:\(([^)]*)\), )?([\w$]+),? ?(?:\(([^)]*)\))?", text)
        if m:
            known = any(f[1] == m[2] and f[4] is not None for f in self.functions)
            if not known:
                fail(f"call of {m[2]}, which is not defined")
            arguments = [x.strip() for x in ((m[1] or "") + "," + (m[3] or "")).split(",") if x.strip()]
            return f"{guard}F_{m[2]}({', '.join(arguments)});"
        op, _, rest = text.partition(" ")
        return f"{guard}{{ {self.instruction(op, split(rest))} }}"

    def read(self):
        globals_ = re.compile(r"^\s*(?:\.visible |\.weak )?\.(?:global|const) (?:\.align (\d+) )?\.(\w+) "
                              r"(\w+)(?:\[(\d+)\])?(?:\s*=\s*([^;]*))?;", re.M)
        for m in globals_.finditer(self.text):
            self.globals[m[3]] = (m[1], TYPES[m[2]], m[4] or "1", (m[5] or "").strip().strip("{}"))
        head = re.compile(r"^(\.visible |\.weak )?\.(func|entry)\s*(\(\.param[^)]*\))?\s*([\w$]+)\s*"
                          r"\(([^)]*)\)\s*(;|(?:\.\w+\s*)*\{)", re.M)
        for m in head.finditer(self.text):
            body = None
            if m[6] != ";":
                depth, at = 1, m.end()
                while depth:
                    depth += {"{": 1, "}": -1}.get(self.text[at], 0)
                    at += 1
                body = self.text[m.end():at - 1]
            self.functions.append((m[2], m[4], bool(m[3]), len(split(m[5])), body))

    def write(self):
        out = [PRELUDE]
        for name, (align, type_, count, values) in self.globals.items():
            out.append(f"static _Alignas({align or 8}) {type_} G_{name}[{count}] = {{{values}}};")
        for kind, name, result, count, body in self.functions:
            names = (["void *func_retval0"] if result else []) + [
                f"void *{name}_param_{k}" for k in range(count)]
            head = f"{'static ' if kind == 'func' else ''}void F_{name}({', '.join(names) or 'void'})"
            out.append(head + (";" if body is None else " {"))
            if body is None:
                continue
            body = re.sub(r"([\w$]+):\s*\n", r"\1:;", body)
            body = re.sub(r"([{}])\s*\n", r";\1;", body)
            for text in body.split(";"):
                text = " ".join(text.split())
                # braces within an operand list belong to it
                if text:
                    out.append("  " + self.statement(text))
            out.append("}")
        kernels = [f[1] for f in self.functions if f[0] == "entry"]
        out.append("const struct { const char *name; void (*run)(void *, void *); } kernels[] = {")
        out += [f'  {{"{k}", F_{k}}},' for k in kernels]
        out.append("  {0, 0}};")
        return "\n".join(out)


def main():
    if len(sys.argv) != 3:
        fail("usage: ptx_to_c.py IN.ptx OUT.c")
    translator = Translator(open(sys.argv[1]).read())
    translator.read()
    with open(sys.argv[2], "w") as out:
        print(translator.write(), file=out)


main()
