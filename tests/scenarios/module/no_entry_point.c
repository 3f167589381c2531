/* A shared library that has the function FUNCTION instead of the entry point of a module. */
const void* FUNCTION(unsigned version) {
  return (void)version, (const void*)0;
}
