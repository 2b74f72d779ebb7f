/* Between the file with the headers of an encoder and the one that has only those of the runtime. */
#include "codewheel/transport.h"

size_t set_zero_steps(cw_step *steps, size_t capacity);
