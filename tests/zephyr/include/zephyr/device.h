/* Stand-ins for what the drivers use of Zephyr, declared after its documentation. One encoder is on the bus. */
#ifndef STAND_IN_DEVICE_H
#define STAND_IN_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct device {
    const void *config;
    void *data;
    const void *api;
    int (*init)(const struct device *dev);
};

/* The encoder, with the properties that the test passes to the compiler. */
#define DT_INST_FOREACH_STATUS_OKAY(define) define(0)
#define DT_INST_ENUM_IDX(n, property) ENUM_IDX_##property
#define DT_INST_PROP(n, property) PROP_##property

extern const struct device encoder;

#endif
