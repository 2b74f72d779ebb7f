#ifndef STAND_IN_SPI_H
#define STAND_IN_SPI_H

#include <zephyr/device.h>

#define SPI_OP_MODE_MASTER 0U
#define SPI_MODE_CPOL 2U
#define SPI_MODE_CPHA 4U
#define SPI_TRANSFER_MSB 0U
#define SPI_WORD_SET(bits) ((bits) << 5U)

struct spi_config {
    uint32_t operation;
};

struct spi_dt_spec {
    struct spi_config config;
};

struct spi_buf {
    void *buf;
    size_t len;
};

struct spi_buf_set {
    const struct spi_buf *buffers;
    size_t count;
};

#define SPI_DT_SPEC_INST_GET(n, flags, delay) {{flags}}

bool spi_is_ready_dt(const struct spi_dt_spec *spec);
int spi_read_dt(const struct spi_dt_spec *spec, const struct spi_buf_set *rx);
int spi_transceive_dt(const struct spi_dt_spec *spec, const struct spi_buf_set *tx, const struct spi_buf_set *rx);

#endif
