#ifndef STAND_IN_EMUL_H
#define STAND_IN_EMUL_H

#include <zephyr/device.h>

struct emul {
    int (*init)(const struct emul *target, const struct device *parent);
    void *data;
    const void *config;
    const void *bus_api;
};

#define EMUL_DT_INST_DEFINE(n, init_function, data_address, config_address, api, backend_api) \
    const struct emul emulated_encoder = {init_function, data_address, config_address, api}

extern const struct emul emulated_encoder;

#endif
