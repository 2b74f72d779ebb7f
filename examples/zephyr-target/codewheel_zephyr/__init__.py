"""Target of codewheel for Zephyr: a module of sensor drivers over the C headers, with bindings and emulators."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypedDict

from codewheel.model import Manufacturer
from codewheel.render import Templates
from codewheel.targets import NO_OPTIONS, Library, Options, Target

from .driver import Driver, drivers_of, quoted, setting


class Module(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    prefix: Annotated[str, "prefix of all names in C"]
    drivers: Annotated[list[Driver], "the interfaces with a driver"]
    buses: Annotated[list[str], "the interfaces that any of them uses: biss, ssi, spi"]


class Family(TypedDict):
    prefix: Annotated[str, "prefix of all names in C"]
    d: Annotated[Driver, "the interface"]


_OF_MODULE = {
    "CMakeLists.txt": "CMakeLists.txt.jinja",
    "Kconfig": "Kconfig.jinja",
    "zephyr/module.yml": "module.yml.jinja",
    "dts/bindings/vendor-prefixes.txt": "vendor-prefixes.txt.jinja",
    "drivers/encoder.h": "encoder.h.jinja",
    "drivers/encoder.c": "encoder.c.jinja",
}


def files(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the module of each manufacturer that has an encoder with a driver."""
    module_files = {}
    for maker, devices in library.by_manufacturer():
        drivers = [driver for device in devices for driver in drivers_of(device)]
        if not drivers:
            continue
        folder, prefix = f"zephyr/{maker.name}-encoders", f"{maker.name}_encoder"
        buses = sorted({driver.bus for driver in drivers})
        module: Module = {"maker": maker, "prefix": prefix, "drivers": drivers, "buses": buses}
        for path, template in _OF_MODULE.items():
            module_files[f"{folder}/{path}"] = TEMPLATES.render(template, module, library.own_templates)
        for bus in buses:
            text = TEMPLATES.render(f"encoder_{bus}.c.jinja", module, library.own_templates)
            module_files[f"{folder}/drivers/encoder_{bus}.c"] = text
        for driver in drivers:
            family: Family = {"prefix": prefix, "d": driver}
            code = TEMPLATES.render("family.c.jinja", family, library.own_templates)
            module_files[f"{folder}/drivers/{driver.stem}.c"] = code
            binding = TEMPLATES.render("binding.yaml.jinja", family, library.own_templates)
            module_files[f"{folder}/dts/bindings/sensor/{driver.binding}"] = binding
    return module_files


_MODULE_TEMPLATES = (*_OF_MODULE.values(), *(f"encoder_{bus}.c.jinja" for bus in ("biss", "ssi", "spi")))
TEMPLATES = Templates(
    Path(__file__).parent / "templates",
    values={**dict.fromkeys(_MODULE_TEMPLATES, Module), "family.c.jinja": Family, "binding.yaml.jinja": Family},
    filters={item.__name__: item for item in (quoted, setting)},
)
TARGET = Target(
    name="zephyr",
    summary="sensor drivers for Zephyr, over the headers of the C target",
    files=files,
    templates=TEMPLATES,
)
