#ifndef STAND_IN_SPI_EMUL_H
#define STAND_IN_SPI_EMUL_H

#include <zephyr/drivers/emul.h>
#include <zephyr/drivers/spi.h>

struct spi_emul_api {
    int (*io)(const struct emul *target, const struct spi_config *config, const struct spi_buf_set *tx,
        const struct spi_buf_set *rx);
};

#endif
