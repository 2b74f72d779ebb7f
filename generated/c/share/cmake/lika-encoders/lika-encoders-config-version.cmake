# Whether version 0.1.0 is what find_package(lika-encoders) asks for: that one, or an older one after which
# nothing has broken. A new first number breaks; before 1.0.0 a new second one does.
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
