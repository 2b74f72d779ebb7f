/* Lists of steps, built by a file that includes the headers of an encoder. */
#include "codewheel/transport.h"

#include "infineon/tle5012b_spi_procedures.h"

#include "spi_list.h"

size_t set_zero_steps(cw_step *steps, size_t capacity)
{
    size_t count = 0U;
    const cw_result result =
        infineon_tle5012b_spi_set_zero_steps(INFINEON_TLE5012B_SPI_TLE5012B, 0x760U, steps, capacity, &count);
    return (result == CW_OK) ? count : 0U;
}
