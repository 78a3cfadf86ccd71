"""Structs of the public headers whose members are rows of a table of fields (src/base/field.h): each
member has its row, or stands here with why it has none, and a comment in its header; each row is of a
member. usage: field_rows.py SOURCE_DIR"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])

MEASURES = 'src/report/measure_tables.c'
CLUMPS = 'src/report/clump_tables.c'
# A table: its file, what a row looks like there, with the member, and the struct.
TABLES = (
    (MEASURES, r'^    [MV]\((\w+)\)', 'scree_measures'),
    (MEASURES, r'^    T\((\w+)\)', 'scree_topology'),
    (MEASURES, r'^    D\((\w+)\)|(?<=,) +D\((\w+)\)', 'scree_descriptors'),
    (CLUMPS, r'SCREE_FIELD_\w+\(\s*scree_clump,(?:\s*"\w+",)?\s*(\w+)', 'scree_clump'),
    ('src/scene/sensors.c', r'COLUMN\("\w+", "[^"]*", seen\.(\w+)', 'scree_observation'),
    ('src/scene/sensors.c', r'COLUMN\("\w+", "[^"]*", book\.(\w+)', 'scree_scene_book'),
    ('src/report/scene_files.c', r'OF\(&b, (\w+)\)', 'scree_scene_book'),
    ('src/study/record.h', r'X\(\w+, result\.pile\.repose\.(\w+)', 'scree_repose'),
    ('src/report/heap_json.c', r'OF\(h, (\w+)\)|\bh->(\w+)', 'scree_repose'),
    ('src/study/record.h', r'X\(\w+, result\.pile\.(\w+)', 'scree_pile'),
    ('src/report/heap_json.c', r'scree_pile, (?:"\w+", "\w*", )?(\w+)', 'scree_pile'),
)

# Members without a row, by struct, and why.
PLACE = 'a place, for programs'
FOR_WORLDS = 'for programs that step a world themselves'
WITHOUT = {
    'scree_measures': {'has_volume': 'what the rows of V need'},
    'scree_clump': {'sphere_count': 'begins every line', 'spheres': 'a list', 'useless_count': 'ends every line'},
    'scree_observation': {
        'fracture': 'part of the ledger',
        'applied_work': 'part of the ledger',
        'momentum': FOR_WORLDS,
        'angular_momentum': FOR_WORLDS,
        'body_count': "the book's inside_count",
        'removed_count': "the book's left_count",
        'broken_joints': 'the sensor fragments tells it',
        'depenetrating_pairs': FOR_WORLDS,
        'depenetration_count': FOR_WORLDS,
        'hardened_count': FOR_WORLDS,
        'stiffness_missing': FOR_WORLDS,
    },
    'scree_repose': {'cone_apex': PLACE, 'axis': PLACE},
}


def struct_body(name):
    for header in sorted((root / 'include/scree').glob('*.h')):
        found = re.search(r'typedef struct %s \{\n(.*?)\n\} %s;' % (name, name), header.read_text(), re.S)
        if found:
            return found.group(1)
    sys.exit(f'no public struct {name}')


def members(body):
    """Each member and its comment: behind it, or above it up to a blank line."""
    above = ''
    for piece in re.findall(r'/\*.*?\*/|\n\s*\n|[^;/]+;(?:[ \t]*/\*.*?\*/)?', body, re.S):
        text = piece.strip()
        if text.startswith('/*') or not text:
            above = text
            continue
        declaration, _, comment = text.partition(';')
        first, *others = declaration.split(',')
        for name in [first.split()[-1], *others]:
            yield re.match(r'[\s*]*(\w+)', name).group(1), comment.strip() or above


failures = []
for struct in dict.fromkeys(struct for _, _, struct in TABLES):
    rows = set()
    for path, row, of in TABLES:
        if of == struct:
            text = (root / path).read_text()
            rows.update(found[found.lastindex] for found in re.finditer(row, text, re.M))
    comments = dict(members(struct_body(struct)))
    without = WITHOUT.get(struct, {})
    failures += [f'{struct}.{name}: no row' for name in comments if name not in rows and name not in without]
    failures += [f'{struct}.{name}: no comment' for name, comment in comments.items() if not comment]
    failures += [f'{struct}.{name}: a row of no member' for name in rows if name not in comments]
    failures += [f'{struct}.{name}: has a row, or is none' for name in without if name in rows or name not in comments]
print('\n'.join(failures))
sys.exit(bool(failures))
