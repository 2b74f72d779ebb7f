#ifndef STAND_IN_SENSOR_H
#define STAND_IN_SENSOR_H

#include <zephyr/device.h>

#define CONFIG_SENSOR_INIT_PRIORITY 90

enum sensor_channel {
    SENSOR_CHAN_LIGHT,
    SENSOR_CHAN_ROTATION,
    SENSOR_CHAN_ALL
};

struct sensor_value {
    int32_t val1; /* integer part */
    int32_t val2; /* millionths */
};

struct sensor_driver_api {
    int (*attr_set)(const struct device *dev);
    int (*sample_fetch)(const struct device *dev, enum sensor_channel channel);
    int (*channel_get)(const struct device *dev, enum sensor_channel channel, struct sensor_value *value);
};

#define SENSOR_DEVICE_DT_INST_DEFINE(n, init_function, pm, data_address, config_address, level, priority, driver_api) \
    const struct device encoder = {config_address, data_address, driver_api, init_function}

#endif
