"""Figures for print: functions of plain data that give matplotlib figures."""
