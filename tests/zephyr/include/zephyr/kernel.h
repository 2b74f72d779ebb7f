#include <stdint.h>
void k_busy_wait(uint32_t us);
