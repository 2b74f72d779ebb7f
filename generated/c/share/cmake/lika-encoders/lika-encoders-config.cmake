# Headers for encoders by Lika Electronic: for find_package(lika-encoders), both in the original folder and after installation.
get_filename_component(_lika_encoders_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET lika::encoders)
  add_library(lika::encoders INTERFACE IMPORTED)
  set_target_properties(lika::encoders PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${_lika_encoders_prefix}/include")
endif()
unset(_lika_encoders_prefix)
