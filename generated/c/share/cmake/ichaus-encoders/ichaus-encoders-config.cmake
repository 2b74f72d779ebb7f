# Headers for encoders by iC-Haus: for find_package(ichaus-encoders), both in the original folder and after installation.
get_filename_component(_ichaus_encoders_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET ichaus::encoders)
  add_library(ichaus::encoders INTERFACE IMPORTED)
  set_target_properties(ichaus::encoders PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${_ichaus_encoders_prefix}/include")
endif()
unset(_ichaus_encoders_prefix)
