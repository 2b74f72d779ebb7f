# Accept find_package(ichaus-encoders) for version 0.1.0 or an older compatible version. A new major version
# breaks compatibility. Before 1.0.0, a new minor version does.
set(PACKAGE_VERSION "0.1.0")
string(REGEX MATCH "^(0\\.[0-9]+|[1-9][0-9]*)" own "${PACKAGE_VERSION}")
string(REGEX MATCH "^(0\\.[0-9]+|[1-9][0-9]*|0$)" asked "${PACKAGE_FIND_VERSION}")
if(PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION OR NOT (own STREQUAL asked OR asked STREQUAL "" OR asked STREQUAL "0"))
  set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
  if(PACKAGE_VERSION VERSION_EQUAL PACKAGE_FIND_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
  endif()
endif()
