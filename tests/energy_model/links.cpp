// The program links the objects of one part of the energy model: it has to define all that it uses.
int main() { return 0; }
