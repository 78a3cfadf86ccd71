/* The report's script, in a file of its own: the page in the browser, which draws by the same
 * script, has it once and links another in its place (web/wasm/session.c). */
#include "report/page_parts.h"

#include "report/page_script.inc"
