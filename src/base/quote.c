/* A row: what stands before and behind, which texts stay bare, and how one character is written. A
 * text that stays bare has none but the characters of `plain`, and is no word of the language. */
#include "base/quote.h"

#include "base/alloc.h"

#include <string.h>
#include <strings.h>

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
#define DIGITS  "0123456789"

enum { PIECE_BYTES = 16 };

/* A character of UTF-8, and what stands for it. */
typedef struct character {
  const char *bytes;
  size_t length;
  uint32_t code;
} character;

static character next_character(const char *text) {
  static const unsigned char heads[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
  size_t length = scree_utf8_length(text);
  if (!length) return (character){"\xef\xbf\xbd", 3, 0xfffd};
  character c = {text, length, (unsigned char)*text & heads[length]};
  for (size_t i = 1; i < length; i++) c.code = c.code << 6 | ((unsigned char)text[i] & 0x3f);
  return c;
}

/* C0, C1 and DEL. */
static bool is_control(uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

static void keep(const character *c, char piece[PIECE_BYTES]) {
  memcpy(piece, c->bytes, c->length);
  piece[c->length] = 0;
}

/* YAML 1.1, 5.1: what is not printable, and the ends of lines beyond ASCII. */
static bool is_unprintable(uint32_t code) {
  return is_control(code) || code == 0x2028 || code == 0x2029 || code == 0xfeff || code == 0xfffe ||
         code == 0xffff;
}

static void put(char piece[PIECE_BYTES], const char *text) {
  snprintf(piece, PIECE_BYTES, "%s", text);
}

static void put_yaml(const character *c, char piece[PIECE_BYTES]) {
  keep(c, piece);
  if (c->code == '"' || c->code == '\\')
    snprintf(piece, PIECE_BYTES, "\\%c", (char)c->code);
  else if (is_unprintable(c->code))
    snprintf(piece, PIECE_BYTES, c->code < 0x100 ? "\\x%02x" : "\\u%04x", (unsigned)c->code);
}

static void put_json(const character *c, char piece[PIECE_BYTES]) {
  put_yaml(c, piece);
  if (is_unprintable(c->code) || c->code == 0xfffd ||
      (c->code < 0x80 && strchr("<>&", (int)c->code)))
    snprintf(piece, PIECE_BYTES, "\\u%04x", (unsigned)c->code);
}

static void put_csv(const character *c, char piece[PIECE_BYTES]) {
  keep(c, piece);
  if (c->code == '"') put(piece, "\"\"");
}

static void put_html(const character *c, char piece[PIECE_BYTES]) {
  bool is_space = c->code == '\n' || c->code == '\t';
  keep(c, piece);
  if (c->code < 0x80 && strchr("<>&\"'", (int)c->code))
    snprintf(piece, PIECE_BYTES, "&#%u;", (unsigned)c->code);
  else if ((is_control(c->code) && !is_space) || c->code == 0xfffe || c->code == 0xffff)
    put(piece, "\xef\xbf\xbd");
}

/* An attribute would make blanks of line ends. */
static void put_xml(const character *c, char piece[PIECE_BYTES]) {
  put_html(c, piece);
  if (c->code == '\n' || c->code == '\t' || c->code == '\r')
    snprintf(piece, PIECE_BYTES, "&#%u;", (unsigned)c->code);
}

static void put_shell(const character *c, char piece[PIECE_BYTES]) {
  keep(c, piece);
  if (c->code == '\'') put(piece, "'\\''");
}

static void put_gnuplot(const character *c, char piece[PIECE_BYTES]) {
  keep(c, piece);
  if (is_control(c->code)) put(piece, " ");
  if (c->code == '\'') put(piece, "''");
}

static void put_gnuplot_label(const character *c, char piece[PIECE_BYTES]) {
  put_gnuplot(c, piece);
  if (c->code < 0x80 && strchr("_^@&~{}\\", (int)c->code))
    snprintf(piece, PIECE_BYTES, "\\%c", (char)c->code);
}

static void put_comment(const character *c, char piece[PIECE_BYTES]) {
  keep(c, piece);
  if (is_control(c->code) || c->code == 0x2028 || c->code == 0x2029) put(piece, " ");
  if (c->code == '\\') put(piece, "/");
}

static void put_name(const character *c, char piece[PIECE_BYTES]) {
  snprintf(piece, PIECE_BYTES, "%c",
           c->code < 0x80 && strchr(LETTERS DIGITS "_-.", (int)c->code) ? (char)c->code : '_');
}

/* No number, date, or word with a meaning of YAML 1.1 begins with a letter and holds none of these
 * characters but the listed ones. */
static bool is_yaml_word(const char *text) {
  static const char *const words[] = {"true", "false", "yes", "no",  "on", "off",
                                      "null", "y",     "n",   "nan", "inf"};
  if (!strchr(LETTERS "_/", *text) && strncmp(text, "./", 2) != 0 && strncmp(text, "../", 3) != 0)
    return true;
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (!strcasecmp(text, words[i])) return true;
  return false;
}

/* What a spreadsheet or another reader of tables drops at either end, or takes for a comment. */
static bool is_csv_word(const char *text) {
  return *text == '%' || !strncmp(text, "//", 2) || *text == ' ' || *text == '\t' ||
         (*text && strchr(" \t", text[strlen(text) - 1]));
}

static const struct {
  const char *quotes;                /* before and behind */
  const char *plain, *not_plain;     /* of the characters of bare texts, one list or the other */
  bool (*is_word)(const char *text); /* a bare text that would be read as something else */
  void (*put)(const character *c, char piece[PIECE_BYTES]);
} rows[SCREE_QUOTING_COUNT] = {
    [SCREE_QUOTE_JSON] = {.quotes = "\"", .put = put_json},
    [SCREE_QUOTE_YAML] = {"\"", LETTERS DIGITS "_-./", NULL, is_yaml_word, put_yaml},
    [SCREE_QUOTE_CSV] = {"\"", NULL, ",;\"#\r\n", is_csv_word, put_csv},
    [SCREE_QUOTE_XML] = {.quotes = "", .put = put_xml},
    [SCREE_QUOTE_HTML] = {.quotes = "", .put = put_html},
    [SCREE_QUOTE_SHELL] = {"'", LETTERS DIGITS "-_=./,:+@%", NULL, NULL, put_shell},
    [SCREE_QUOTE_GNUPLOT] = {.quotes = "'", .put = put_gnuplot},
    [SCREE_QUOTE_GNUPLOT_LABEL] = {.quotes = "", .put = put_gnuplot_label},
    [SCREE_QUOTE_COMMENT] = {.quotes = "", .put = put_comment},
    [SCREE_QUOTE_NAME] = {.quotes = "", .put = put_name},
};

static bool is_bare(scree_quoting quoting, const char *text) {
  const char *plain = rows[quoting].plain, *not_plain = rows[quoting].not_plain;
  if (!plain && !not_plain) return false;
  if (plain && (!*text || text[strspn(text, plain)])) return false;
  if (not_plain && text[strcspn(text, not_plain)]) return false;
  return !rows[quoting].is_word || !rows[quoting].is_word(text);
}

/* Into piece, and text goes behind what it stands for; false at the end. */
static bool next_piece(scree_quoting quoting, const char **text, char piece[PIECE_BYTES]) {
  size_t length = scree_utf8_length(*text);
  character c = next_character(*text);
  if (!**text) return false;
  if (!length && quoting == SCREE_QUOTE_SHELL) c = (character){*text, 1, (unsigned char)**text};
  rows[quoting].put(&c, piece);
  *text += length ? length : 1;
  return true;
}

static const char *quotes_of(scree_quoting quoting, const char *text) {
  return is_bare(quoting, text) ? "" : rows[quoting].quotes;
}

void scree_quote(FILE *stream, scree_quoting quoting, const char *text) {
  const char *quotes = quotes_of(quoting, text);
  char piece[PIECE_BYTES];
  fputs(quotes, stream);
  while (next_piece(quoting, &text, piece)) fputs(piece, stream);
  fputs(quotes, stream);
}

const char *scree_quote_text(scree_quoting quoting, const char *text, char *quoted, size_t size) {
  const char *quotes = quotes_of(quoting, text);
  char piece[PIECE_BYTES];
  size_t used = (size_t)snprintf(quoted, size, "%s", quotes);
  while (next_piece(quoting, &text, piece) && used + strlen(piece) + strlen(quotes) < size)
    used += (size_t)snprintf(quoted + used, size - used, "%s", piece);
  snprintf(quoted + used, size - used, "%s", quotes);
  return quoted;
}

char *scree_quoted(scree_quoting quoting, const char *text) {
  size_t size = PIECE_BYTES * strlen(text) + 3;
  char *quoted = scree_alloc(size, 1);
  if (quoted) scree_quote_text(quoting, text, quoted, size);
  return quoted;
}
