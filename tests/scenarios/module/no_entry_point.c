/* A library without the entry point of a module, FUNCTION in its place. */
const void* FUNCTION(unsigned version) {
  return (void)version, (const void*)0;
}
