#include "cli/terminal.h"

#include "base/platform.h"

#include <math.h>
#include <signal.h>
#include <string.h>

enum { BAR_WIDTH = 24, LINE_WIDTH = 78, LINE_BYTES = 128 };

/* Lines in a log: the first one after so long, each later one after twice as long, up to the most.
 */
static const double first_line_s = 4, longest_pause_s = 600;

static volatile sig_atomic_t received_signal;
static bool settled;

static struct {
  cli_progress_kind kind;
  bool drawn;
  char phase[48];
  double phase_start;             /* s, monotonic */
  double start, next_line, pause; /* of a log */
} terminal;

static void on_signal(int number) {
  received_signal = number;
}

static void format_seconds(char *text, size_t size, double seconds) {
  if (!isfinite(seconds))
    snprintf(text, size, "...");
  else if (seconds < 100)
    snprintf(text, size, "%.0f s", seconds);
  else if (seconds < 6000)
    snprintf(text, size, "%.0f min", seconds / 60);
  else
    snprintf(text, size, "%.1f h", seconds / 3600);
}

/* How much of a line may be written without going on to the next. */
static int line_width(void) {
  int columns = scree_terminal_columns();
  return columns > 0 && columns <= LINE_WIDTH ? columns - 1 : LINE_WIDTH;
}

static bool line_is_due(void) {
  if (terminal.kind == CLI_PROGRESS_LINE) return true;
  if (terminal.kind == CLI_PROGRESS_NONE || scree_now() < terminal.next_line) return false;
  terminal.pause = fmin(2 * terminal.pause, longest_pause_s);
  terminal.next_line = scree_now() + terminal.pause;
  return true;
}

static void put_line(const char *text) {
  if (terminal.kind == CLI_PROGRESS_LOG) {
    char elapsed[32];
    format_seconds(elapsed, sizeof elapsed, scree_now() - terminal.start);
    fprintf(stderr, "scree, after %s: %s\n", elapsed, text);
    return;
  }
  int width = line_width();
  fprintf(stderr, "\r%-*.*s", width, width, text);
  fflush(stderr);
  terminal.drawn = true;
}

/* ", 42 s left"; nothing where it is not known, or would be 0 s while work goes on. */
static void format_left(char *text, size_t size, double seconds) {
  char number[32];
  format_seconds(number, sizeof number, seconds);
  snprintf(text, seconds < 0.5 || !isfinite(seconds) ? 1 : size, ", %s left", number);
}

static void note_phase(const char *phase) {
  if (strncmp(phase, terminal.phase, sizeof terminal.phase - 1) != 0) {
    snprintf(terminal.phase, sizeof terminal.phase, "%s", phase);
    terminal.phase_start = scree_now();
  }
}

static void draw(const char *phase, double fraction) {
  double elapsed = scree_now() - terminal.phase_start;
  double seconds = fraction > 0.01 ? elapsed * (1 - fraction) / fraction : INFINITY;
  char left[40], bar[BAR_WIDTH + 1], line[LINE_BYTES];
  format_left(left, sizeof left, seconds);
  int full = (int)(fraction * BAR_WIDTH);
  for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < full ? '#' : '.';
  bar[BAR_WIDTH] = 0;
  if (terminal.kind == CLI_PROGRESS_LOG)
    snprintf(line, sizeof line, "%s: %.0f %%%s", phase, 100 * fraction, left);
  else if (line_width() == LINE_WIDTH)
    snprintf(line, sizeof line, "%-30.30s [%s] %3.0f %%%s", phase, bar, 100 * fraction, left);
  else
    snprintf(line, sizeof line, "%3.0f %%%s, %s", 100 * fraction, left, phase);
  put_line(line);
}

void cli_terminal_line(const char *text) {
  if (line_is_due()) put_line(text);
}

void cli_terminal_seconds(char *text, size_t size, double seconds) {
  format_seconds(text, size, seconds);
}

static bool report(void *context, const char *phase, double fraction) {
  (void)context;
  note_phase(phase);
  if (line_is_due()) draw(phase, fraction < 0 ? 0 : fraction > 1 ? 1 : fraction);
  return !cli_interrupted();
}

static bool report_share(void *context, const char *phase, double fraction) {
  cli_share *share = context;
  const scree_progress *whole = share->whole;
  share->done = fmax(share->done, share->base + share->part * fmin(fmax(fraction, 0), 1));
  return whole->report(whole->context, share->phase ? share->phase : phase, share->done);
}

cli_share cli_share_of(const scree_progress *whole, const char *phase) {
  return (cli_share){.whole = whole, .phase = phase};
}

const scree_progress *cli_share_enter(cli_share *share, double base, double part) {
  share->base = base;
  share->part = part;
  share->progress = (scree_progress){report_share, share, share->whole->interval};
  return &share->progress;
}

bool cli_terminal_settle(void) {
  scree_signals_hold();
  settled = !received_signal;
  if (settled) scree_signals_catch(on_signal, true); /* what is printed is not cut off */
  scree_signals_go_on();
  return settled;
}

void cli_terminal_release(void) {
  scree_signals_release(on_signal);
}

const scree_progress *cli_terminal_start(cli_progress_kind kind) {
  static const scree_progress progress = {report, NULL, 0.1};
  scree_signals_catch(on_signal, false);
  terminal.kind = kind;
  terminal.pause = first_line_s;
  terminal.start = scree_now();
  terminal.next_line = terminal.start + first_line_s;
  return &progress;
}

void cli_terminal_end(void) {
  if (terminal.drawn) fprintf(stderr, "\r%*s\r", line_width(), "");
  terminal.drawn = false;
}

bool cli_interrupted(void) {
  return received_signal != 0 && !settled;
}

void cli_terminal_reraise(void) {
  scree_signal_end(received_signal);
}
