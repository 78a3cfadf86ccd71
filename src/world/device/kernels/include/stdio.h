#pragma once
#include <stddef.h>
typedef struct scree_no_file FILE;
int snprintf(char *text, size_t size, const char *format, ...);
